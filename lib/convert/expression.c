/*
 * expression: parses which variables become a grid, and computes a field of several. The grammar:
 *
 *     request   NAME | NAME = sum
 *     sum       product { (+|-) product }
 *     product   power { (*|/) power }
 *     power     [-] factor [ ^ digit ]
 *     factor    number | variable | ( sum ) | sqrt ( sum ) | hypot ( sum , sum )
 *
 * The steps are in the order of a stack machine, so that a node is computed in one pass.
 */
#include "convert/convert.h"
#include "units/units.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#define EXPECTED "expected a variable, or NAME=EXPRESSION"

struct parser {
    const char *at;
    struct convert_request *r;
    convert_known *known;
    void *ctx;
    char *err;
    int depth; /* of brackets and signs */
};

static bool sum(struct parser *p);

static bool fail(struct parser *p, const char *want)
{
    char word[ERR_WORD];
    return err_set(p->err, "%s stands where %s is expected",
        *p->at ? err_word(word, p->at, strlen(p->at)) : "the end", want);
}

static void skip_blanks(struct parser *p)
{
    while (*p->at == ' ') p->at++;
}

static bool took(struct parser *p, char c)
{
    skip_blanks(p);
    if (*p->at != c) return false;
    p->at++;
    return true;
}

/* The operator that stands there, of those in `some`, which it passes; 0 if there is none. */
static char took_one(struct parser *p, const char *some)
{
    skip_blanks(p);
    return *p->at && strchr(some, *p->at) ? *p->at++ : '\0';
}

static bool add(struct parser *p, struct convert_step s)
{
    if (p->r->n_steps == CONVERT_STEPS)
        return err_set(p->err, "too long, expected %d steps at most", CONVERT_STEPS);
    p->r->step[p->r->n_steps++] = s;
    return true;
}

static bool add_variable(struct parser *p, size_t n)
{
    struct convert_request *r = p->r;
    int i = 0;
    while (i < r->n && (strncmp(r->part[i], p->at, n) != 0 || r->part[i][n])) i++;
    if (i == CONVERT_PARTS)
        return err_set(p->err, "too many variables, expected %d at most", CONVERT_PARTS);
    if (i == r->n) {
        if (n >= CONVERT_TEXT) return err_set(p->err, "a name is too long");
        memcpy(r->part[r->n], p->at, n);
        r->part[r->n++][n] = '\0';
    }
    p->at += n;
    return add(p, (struct convert_step){CONVERT_VARIABLE, i, 0});
}

static bool in_name(char c)
{
    return isalnum((unsigned char)c) || (c && strchr("_./:@", c)) || (unsigned char)c >= 0x80;
}

/* The bytes of a name: the longest one that is known, so that 10u and grp/U are names, and a
 * known a before /b is a name too. Without any, that of the letters up to an operator. */
static size_t name_length(const struct parser *p)
{
    size_t all = 0, plain = 0;
    char name[CONVERT_TEXT];
    while (p->at[all] && in_name(p->at[all])) all++;
    for (size_t n = all; n > 0; n--) {
        if (n >= sizeof name) continue;
        memcpy(name, p->at, n);
        name[n] = '\0';
        bool ends = n == all || !isalnum((unsigned char)p->at[n]) || p->at[n - 1] == '/';
        if (ends && p->known(p->ctx, name)) return n;
    }
    while (plain < all && p->at[plain] != '/') plain++;
    return plain;
}

static bool number(struct parser *p)
{
    char text[32] = "";
    double v;
    size_t n = strspn(p->at, "0123456789.");
    const char *e = p->at + n;
    if (n && (*e == 'e' || *e == 'E')) {
        const size_t sign = e[1] == '-' || e[1] == '+', digits = strspn(e + 1 + sign, "0123456789");
        n += digits ? 1 + sign + digits : 0;
    }
    if (n && n < sizeof text) memcpy(text, p->at, n);
    if (!parse_real(text, -GRID_MAX, GRID_MAX, &v)) return fail(p, "a number or a variable");
    p->at += n;
    return add(p, (struct convert_step){CONVERT_NUMBER, 0, v});
}

/* sqrt( or hypot(, behind the name */
static bool call(struct parser *p, enum convert_operation what)
{
    if (!took(p, '(')) return fail(p, "(");
    if (!sum(p)) return false;
    if (what == CONVERT_HYPOT && !took(p, ',')) return fail(p, ",");
    if (what == CONVERT_HYPOT && !sum(p)) return false;
    return took(p, ')') ? add(p, (struct convert_step){what, 0, 0}) : fail(p, ")");
}

static bool factor(struct parser *p)
{
    skip_blanks(p);
    if (took(p, '(')) return sum(p) && (took(p, ')') || fail(p, ")"));
    if (*p->at == '\'') { /* a name with other characters */
        const char *end = strchr(++p->at, '\'');
        if (!end || end == p->at) return fail(p, "a name and '");
        bool good = add_variable(p, (size_t)(end - p->at));
        p->at++;
        return good;
    }
    const size_t n = name_length(p);
    char name[CONVERT_TEXT] = "";
    if (n < sizeof name) memcpy(name, p->at, n);
    const bool known = n && p->known(p->ctx, name);
    if (!known && (strcmp(name, "sqrt") == 0 || strcmp(name, "hypot") == 0)) {
        p->at += n;
        return call(p, *name == 's' ? CONVERT_SQRT : CONVERT_HYPOT);
    }
    if (!known && (isdigit((unsigned char)*p->at) || *p->at == '.' || !n)) return number(p);
    return add_variable(p, n);
}

static bool power(struct parser *p)
{
    if (++p->depth > CONVERT_STEPS) return err_set(p->err, "too deep, expected fewer brackets");
    bool good;
    if (took(p, '-'))
        good = add(p, (struct convert_step){CONVERT_NUMBER, 0, -1}) && power(p) &&
               add(p, (struct convert_step){CONVERT_BY, 0, 0});
    else good = factor(p);
    if (good && took(p, '^')) {
        skip_blanks(p);
        if (*p->at < '1' || *p->at > '9' || isdigit((unsigned char)p->at[1]) || p->at[1] == '.')
            return fail(p, "a power from 1 to 9");
        good = add(p, (struct convert_step){CONVERT_POWER, *p->at++ - '0', 0});
    }
    p->depth--;
    return good;
}

static bool product(struct parser *p)
{
    bool good = power(p);
    for (char c; good && (c = took_one(p, "*/"));)
        good =
            power(p) && add(p, (struct convert_step){c == '*' ? CONVERT_BY : CONVERT_OVER, 0, 0});
    return good;
}

static bool sum(struct parser *p)
{
    bool good = product(p);
    for (char c; good && (c = took_one(p, "+-"));)
        good = product(p) &&
               add(p, (struct convert_step){c == '+' ? CONVERT_PLUS : CONVERT_MINUS, 0, 0});
    return good;
}

static void set_name(struct convert_request *r, const char *from, size_t n)
{
    while (n && from[n - 1] == ' ') n--;
    while (n && *from == ' ') from++, n--;
    snprintf(r->name, GRID_NAME, "%.*s", (int)(n < GRID_NAME ? n : GRID_NAME - 1), from);
}

bool convert_request_parse(const char *text, convert_known *known, void *ctx,
    struct convert_request *r, char err[ERR_BYTES])
{
    const char *equals = strchr(text, '=');
    struct parser p = {equals ? equals + 1 : text, r, known, ctx, err, 0};
    *r = (struct convert_request){.n = 0};
    *err = '\0';
    const char *begin = text + strspn(text, " ");
    const bool call_alone = strncmp(begin, "hypot(", 6) == 0 || strncmp(begin, "sqrt(", 5) == 0;
    if ((!equals && !call_alone) || known(ctx, text)) {
        const char *slash = strrchr(begin, '/');
        size_t n = strlen(begin);
        while (n && begin[n - 1] == ' ') n--;
        set_name(r, slash ? slash + 1 : begin, strlen(slash ? slash + 1 : begin));
        p.at = begin;
        return n ? add_variable(&p, n) : err_set(err, EXPECTED);
    }
    if (!equals) return err_set(err, EXPECTED);
    set_name(r, text, (size_t)(equals - text));
    if (!r->name[0]) return err_set(err, EXPECTED);
    if (!sum(&p)) return false;
    skip_blanks(&p);
    if (*p.at) return fail(&p, "an operator");
    return r->n || err_set(err, "names no variable, expected one at least");
}

/* ---- units ----------------------------------------------------------------------------------- */

/* The unit of a value on the stack. */
struct measure {
    bool number;     /* it has no unit: it takes that of what it is added to */
    bool difference; /* of two values: 0 stays 0 in other units */
    char unit[CONVERT_TEXT];
};

/* Sums need one unit. */
static bool same_unit(const char *a, const char *b, char err[ERR_BYTES])
{
    struct units_linear l;
    char why[ERR_BYTES];
    if (strcmp(a, b) == 0) return true;
    if (units_linear(a, b, &l, why) && fabs(l.factor - 1) < 1e-9 && fabs(l.offset) < 1e-9)
        return true;
    return err_set(err, "the two are in '%.60s' and '%.60s', expected one unit", a, b);
}

static bool combine(
    enum convert_operation what, struct measure *a, const struct measure *b, char err[ERR_BYTES])
{
    const bool scales = what == CONVERT_BY || what == CONVERT_OVER;
    char out[CONVERT_TEXT];
    if (scales) {
        if (b->number) return true;
        if (a->number && what == CONVERT_BY) {
            *a = *b;
            return true;
        }
        a->difference = false;
        if ((!a->number && !a->unit[0]) || !b->unit[0]) {
            a->number = false;
            a->unit[0] = '\0'; /* unknown */
            return true;
        }
        if (!units_product(a->number ? "1" : a->unit, b->unit, what == CONVERT_OVER ? -1 : 1, out,
                sizeof out, err))
            return false;
        *a = (struct measure){.number = false};
        snprintf(a->unit, sizeof a->unit, "%s", out);
        return true;
    }
    if (a->number || b->number) {
        if (a->number) *a = *b;
        return true;
    }
    if (!same_unit(a->unit, b->unit, err)) return false;
    a->difference = what == CONVERT_MINUS
                        ? a->difference == b->difference
                        : what == CONVERT_HYPOT || (a->difference && b->difference);
    return true;
}

bool convert_request_unit(
    struct convert_request *r, const char *const *unit, const bool *difference, char err[ERR_BYTES])
{
    struct measure stack[CONVERT_STEPS + 1] = {{.number = true}};
    int n = 0;
    for (int i = 0; i < r->n_steps; i++) {
        const struct convert_step *s = &r->step[i];
        if (s->what == CONVERT_NUMBER) stack[n++] = (struct measure){.number = true};
        else if (s->what == CONVERT_VARIABLE) {
            stack[n] = (struct measure){.difference = difference && difference[s->index]};
            snprintf(stack[n++].unit, CONVERT_TEXT, "%s", unit[s->index]);
        } else if (s->what == CONVERT_SQRT || s->what == CONVERT_POWER) {
            struct measure *a = &stack[n - 1];
            char out[CONVERT_TEXT];
            const int power = s->what == CONVERT_POWER ? s->index : -2;
            if (a->number || !a->unit[0] || power == 1) continue;
            if (!units_power(a->unit, power, out, sizeof out, err)) return false;
            *a = (struct measure){.number = false};
            snprintf(a->unit, sizeof a->unit, "%s", out);
        } else {
            n--;
            if (!combine(s->what, &stack[n - 1], &stack[n], err)) return false;
        }
    }
    r->difference = stack[0].difference;
    snprintf(r->unit, sizeof r->unit, "%s", stack[0].unit);
    return true;
}

/* ---- values ---------------------------------------------------------------------------------- */

static double computed(enum convert_operation what, double a, double b)
{
    switch (what) {
    case CONVERT_PLUS: return a + b;
    case CONVERT_MINUS: return a - b;
    case CONVERT_BY: return a * b;
    case CONVERT_OVER: return b == 0 ? (double)NAN : a / b;
    default: return isnan(a) || isnan(b) ? (double)NAN : hypot(a, b);
    }
}

double convert_request_at(const struct convert_request *r, const float *const *part, size_t i)
{
    double stack[CONVERT_STEPS + 1] = {0};
    int n = 0;
    for (int k = 0; k < r->n_steps; k++) {
        const struct convert_step *s = &r->step[k];
        switch (s->what) {
        case CONVERT_NUMBER: stack[n++] = s->number; break;
        case CONVERT_VARIABLE: stack[n++] = (double)part[s->index][i]; break;
        case CONVERT_SQRT:
            stack[n - 1] = stack[n - 1] < 0 ? (double)NAN : sqrt(stack[n - 1]);
            break;
        case CONVERT_POWER: stack[n - 1] = pow(stack[n - 1], s->index); break;
        default: n--; stack[n - 1] = computed(s->what, stack[n - 1], stack[n]);
        }
    }
    return stack[0];
}
