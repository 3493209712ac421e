/*
 * number: single precision to the shortest decimal. Six to nine digits are tried. An integer below
 * 1e9 times or divided by a power of ten up to 1e22 is one rounding (W. D. Clinger, "How to read
 * floating point numbers accurately", PLDI 1990), so a try computes exactly what a reader of the
 * text will. Other numbers are left to printf.
 */
#include "mesh/mesh.h"

#include <string.h>

#define DIGITS_MIN 6 /* a shorter decimal is this one without its final zeros */
#define DIGITS_MAX 9
#define POWER_MAX 22

static const double power_of_ten[] = {1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11,
    1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

static double scaled(double v, int power)
{
    return power < 0 ? v / power_of_ten[-power] : v * power_of_ten[power];
}

/* Writes n digits of m with the point behind the first of 10^exponent. */
static size_t put_digits(char *text, uint64_t m, int n, int exponent)
{
    char digits[DIGITS_MAX + 2] = "", *p = text;
    while (m % 10 == 0) m /= 10, n--;
    for (int i = n; i-- > 0; m /= 10) digits[i] = (char)('0' + m % 10);
    if (exponent < -5 || exponent > DIGITS_MAX) {
        *p++ = digits[0];
        if (n > 1) *p++ = '.';
        for (int i = 1; i < n; i++) *p++ = digits[i];
        return (size_t)(p - text) + (size_t)snprintf(p, 8, "e%d", exponent);
    }
    if (exponent < 0) {
        *p++ = '0', *p++ = '.';
        for (int i = exponent + 1; i < 0; i++) *p++ = '0';
    }
    for (int i = 0; i < n || i <= exponent; i++) {
        if (i == exponent + 1 && i > 0) *p++ = '.';
        *p++ = i < n ? digits[i] : '0';
    }
    return (size_t)(p - text);
}

size_t mesh_number(char text[MESH_NUMBER], float v)
{
    const double a = fabs((double)v);
    size_t sign = v < 0;
    if (v == 0) return text[0] = '0', 1;
    text[0] = '-';
    if (a >= 1e-13 && a < 1e21) {
        int exponent = (int)floor(log10(a));
        if (a >= scaled(1, exponent + 1)) exponent++;
        for (int n = DIGITS_MIN; n <= DIGITS_MAX; n++) {
            int power = n - 1 - exponent;
            double m = rint(scaled(a, power));
            if (m < power_of_ten[n - 1] || m > power_of_ten[n]) break;
            if ((float)scaled(m, -power) != (float)a) continue;
            bool rounded_up = m == power_of_ten[n];
            return sign +
                   put_digits(text + sign, (uint64_t)m, n + rounded_up, exponent + rounded_up);
        }
    }
    print_float(text, v, 1);
    return strlen(text);
}
