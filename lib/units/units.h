/* units: conversion of units of measurement through libudunits2. No I/O except its database. */
#ifndef STORMRING_UNITS_H
#define STORMRING_UNITS_H

#include "base/base.h"

/* A value v in one unit is factor * v + offset in the other. */
struct units_linear {
    double factor, offset;
};
/*
 * Finds the conversion between two units, such as "m s**-1" and "knots". "mb" is a millibar, and
 * "gpm" a metre. False with a message in err if a unit is unknown, if they measure different
 * things or not linearly, or if the library was missing when this was built.
 */
bool units_linear(const char *from, const char *to, struct units_linear *l, char err[ERR_BYTES]);

#endif
