/*
 * convert: the part that nc2vtk and grib2vtk share: options, requests, and one output file per
 * time.
 *
 * Call order: convert_option for each letter from getopt; convert_operands after the last. Then
 * list, if o->list, with convert_table_*; otherwise convert_request_parse and convert. On failure
 * all functions except convert_request_parse end the program with a message. A caller must link
 * libudunits2 if it is there.
 */
#ifndef STORMRING_CONVERT_H
#define STORMRING_CONVERT_H

#include "base/base.h"
#include "grid/grid.h"

struct convert_options {
    const char *out; /* -o: a file; %d stands for the time's index; NULL: standard output */
    bool round; /* -c: repeat the first column at the end, if longitudes go all the way round */
    bool list;  /* -l */
    bool roll;  /* -r: the grid begins at longitude `from` */
    double from;
    bool heights;     /* -z: z becomes metres */
    bool standard;    /* -Z: and heights of pressures are those of the standard atmosphere */
    const char *unit; /* -u: of the values; NULL: as in the file */
    bool every;       /* -t all */
    size_t time;      /* -t INDEX */
    const char *file, *what;
};

/* Handles -c, -h, -l, -o, -r, -t, -u, -z and -Z; any other letter prints the usage and exits. */
void convert_option(
    struct convert_options *o, int letter, const char *argument, const char *usage_text);
/* Takes the file and, without -l, the request. Checks that the options go together. */
void convert_operands(struct convert_options *o, int n, char **operand, const char *usage_text);

#define CONVERT_TEXT 256 /* bytes of a name or a cell of a table */
#define CONVERT_PARTS 8  /* variables of an expression */
#define CONVERT_STEPS 64 /* of an expression */
enum convert_operation {
    CONVERT_NUMBER,
    CONVERT_VARIABLE,
    CONVERT_PLUS,
    CONVERT_MINUS,
    CONVERT_BY, /* times */
    CONVERT_OVER,
    CONVERT_POWER,
    CONVERT_SQRT,
    CONVERT_HYPOT
};
struct convert_step {
    enum convert_operation what;
    int index; /* of the variable; the power */
    double number;
};
/* A request: "U", or an expression: "speed=hypot(U,V)". */
struct convert_request {
    char name[GRID_NAME]; /* name of the scalar: "U", without the part before a slash; "speed" */
    char part[CONVERT_PARTS][CONVERT_TEXT]; /* the variables, each once */
    int n;
    struct convert_step step[CONVERT_STEPS]; /* of a machine with a stack */
    int n_steps;
    char unit[CONVERT_TEXT]; /* by convert_request_unit */
    bool difference;
};
/* True if the file has a variable of that name. */
typedef bool convert_known(void *ctx, const char *name);
/* Blanks are ignored. False with a message in err if the text is neither form. */
bool convert_request_parse(const char *text, convert_known *known, void *ctx,
    struct convert_request *r, char err[ERR_BYTES]);
/*
 * Finds the unit of the values from those of the variables. A sum needs one unit, perhaps in other
 * spellings; a number has the unit of what it is added to. `difference`: of the variables; NULL if
 * none is one. False with a message in err if the units do not fit.
 */
bool convert_request_unit(struct convert_request *r, const char *const *unit,
    const bool *difference, char err[ERR_BYTES]);
/* Computes the value of node i. NaN: missing, as are quotients by 0 and roots of negative ones. */
double convert_request_at(const struct convert_request *r, const float *const *part, size_t i);

/* What -z makes heights of. */
enum convert_levels {
    CONVERT_LEVELS_OTHER,
    CONVERT_LEVELS_PRESSURE, /* z is negated pressure */
    CONVERT_LEVELS_HEIGHT,   /* z is a length already */
    CONVERT_LEVELS_FIELD     /* the file has the height of each node */
};
/* Of the members that have a value at a node: their mean, or their standard deviation, the root of
 * the mean square difference from it. */
enum convert_over { CONVERT_ONE, CONVERT_MEAN, CONVERT_SPREAD };
/* Finds it in a word: mean or spread. */
enum convert_over convert_over_of(const char *word);
/* The source of grids. */
struct converter {
    const char *what; /* for messages */
    struct convert_request *request;
    enum convert_levels levels;
    const char *heights_by;  /* for CONVERT_LEVELS_FIELD: the variable, for messages */
    bool standard_too;       /* likewise: -Z would give heights too */
    const char *levels_unit; /* of z */
    const char *plane;       /* of x and y, a string of PROJ; "": none */
    bool degrees;            /* x is longitude in degrees */
    size_t times, members;
    enum convert_over over; /* what is written of several members */
    void *ctx;              /* passed to the functions */
    /* Makes the grid's axes and room for values. */
    void (*axes)(void *ctx, struct grid *g);
    /* Reads the values of a variable of the request at one time. */
    void (*values)(void *ctx, int part, size_t time, size_t member, struct grid *g);
    /* For CONVERT_LEVELS_FIELD: reads the heights of the nodes, in metres. */
    void (*heights)(void *ctx, size_t time, size_t member, struct grid *g);
    /* Writes "; " and names and units of the grid's axes, see stormring-grid(5); z: instead of z's,
     * unless NULL. */
    void (*describe)(const void *ctx, size_t time, const char *z, struct buf *title);
};
/* Writes the grids of the requested times to their files. */
void convert(const struct convert_options *o, const struct converter *c);

/* ---- heights -------------------------------------------------------------------------------- */

/* Geopotential height in metres of a pressure above 0, in the U.S. Standard Atmosphere of 1976. */
double convert_standard_height(double pressure_pa);
/* Makes such heights of pressures in Pa; NaN of those that are not above 0. */
void convert_pressures(struct grid *g);
/* Depth in metres of a pressure in the sea, which is 0 at its surface, at a latitude. */
double convert_sea_depth(double pressure_dbar, double latitude_deg);
/* Makes heights, which are negative, of pressures in the sea, in Pa. y is latitude. */
void convert_sea_pressures(struct grid *g);
/* Levels with this unit that are no pressures: heights, if it is a length. */
enum convert_levels convert_levels_of(const char *unit);
/* Writes a height for each level: the lower quartile of its nodes, so that most columns reach from
 * the lowest to the highest. False with a message in err if they do not ascend. */
bool convert_planes(const struct grid *height, double *plane, char err[ERR_BYTES]);
/*
 * Moves the values of each column from the heights of its nodes to the heights plane[0 .. nz-1], by
 * linear interpolation. NaN where the plane is more than half a layer outside the column's nodes,
 * as in the ground. The grids have the same nodes. Sets values only.
 */
void convert_to_planes(struct grid *g, const struct grid *height, const double *plane);

/* ---- the contents of a file ----------------------------------------------------------------- */

enum { CONVERT_NAME, CONVERT_SHAPE, CONVERT_UNITS, CONVERT_RANGE, CONVERT_TIMES, CONVERT_ABOUT };
#define CONVERT_COLUMNS 6

/* All zero at first. */
struct convert_table {
    struct buf cells, refused;
    size_t width[CONVERT_COLUMNS];
};
/* Adds a row; NULL and "" become "-". */
void convert_table_row(struct convert_table *t, const char *const cell[CONVERT_COLUMNS]);
/* Adds a line below the table. */
void convert_table_refused(struct convert_table *t, const char *name, const char *why);
/* Prints the table, with aligned columns, and frees it. */
void convert_table_print(struct convert_table *t);

/* The least and the greatest value; all zero at first. */
struct convert_range {
    double lo, hi;
    bool any; /* a value is there */
};
void convert_range_add(struct convert_range *r, const struct grid *g);
const char *convert_range_text(const struct convert_range *r, char text[CONVERT_TEXT]);

#endif
