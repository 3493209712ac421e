/*
 * palette: published colour maps, each as 17 colours that were sampled at equal steps from the 256
 * of its source, in sRGB. Linear light between two of them is within 8/255 of the source.
 *
 * Stefan van der Walt, Nathaniel Smith (and Eric Firing), "mpl-colormaps", 2015, CC0: viridis,
 * magma. Fabio Crameri, "Scientific colour maps", version 8.0, 2023, doi:10.5281/zenodo.8035877,
 * MIT licence, Copyright (c) 2023 Fabio Crameri: batlow, vik. grey has equal steps of sRGB.
 *
 * A change of these numbers changes pictures, and needs another version of the formats.
 */
#include "spec/spec.h"

#include <string.h>

static const struct {
    const char *name;
    uint32_t srgb[SPEC_PALETTE_POINTS]; /* 0xRRGGBB */
} palettes[] = {
    {"batlow",
        {0x011959, 0x0d315d, 0x114360, 0x165262, 0x226061, 0x356a59, 0x4d734d, 0x667a3f, 0x818232,
            0xa08a2b, 0xbf9035, 0xdb954c, 0xf29d6c, 0xfca891, 0xfdb4b4, 0xfcc0d6, 0xfaccfa}},
    {"grey",
        {0x000000, 0x101010, 0x202020, 0x303030, 0x404040, 0x505050, 0x606060, 0x707070, 0x808080,
            0x8f8f8f, 0x9f9f9f, 0xafafaf, 0xbfbfbf, 0xcfcfcf, 0xdfdfdf, 0xefefef, 0xffffff}},
    {"magma",
        {0x000004, 0x0a0822, 0x1d1146, 0x36106a, 0x50127c, 0x691c81, 0x822681, 0x9c2e7f, 0xb63779,
            0xcf4170, 0xe65163, 0xf5695c, 0xfb8761, 0xfea571, 0xfec387, 0xfde0a2, 0xfcfdbf}},
    {"vik",
        {0x001261, 0x022b71, 0x034481, 0x0c5e92, 0x2f7ca6, 0x609dbc, 0x92bdd2, 0xc5dbe5, 0xece5e1,
            0xe9cbb9, 0xdcab8f, 0xcf8e68, 0xc37243, 0xb3531f, 0x932e06, 0x741506, 0x590008}},
    {"viridis",
        {0x440154, 0x48186a, 0x472d7b, 0x424086, 0x3b528b, 0x33638d, 0x2c728e, 0x26818e, 0x21908c,
            0x1f9f88, 0x28ae80, 0x3ebc74, 0x5dc963, 0x82d34c, 0xabdc32, 0xd5e21a, 0xfde725}},
};

const char *const spec_palettes[SPEC_N_PALETTES] = {"batlow", "grey", "magma", "vik", "viridis"};

/* x^(1/5) for x in [.001, 1] by Newton's method: pow may differ in the last bit between hosts. */
static double fifth_root(double x)
{
    double y = 1;
    for (int i = 0; i < 20; i++) y -= (y * y * y * y * y - x) / (5 * y * y * y * y);
    return y;
}

/* A component of sRGB in linear light (IEC 61966-2-1). */
static double linear(uint32_t component)
{
    double v = component / 255.0, x = (v + .055) / 1.055;
    return v <= .04045 ? v / 12.92 : x * x * fifth_root(x * x);
}

bool spec_palette(const char *name, size_t n, double rgb[SPEC_PALETTE_POINTS][3])
{
    for (size_t i = 0; i < sizeof palettes / sizeof *palettes; i++) {
        if (strlen(palettes[i].name) != n || memcmp(palettes[i].name, name, n) != 0) continue;
        for (int k = 0; k < SPEC_PALETTE_POINTS; k++)
            for (int c = 0; c < 3; c++)
                rgb[k][c] = linear(palettes[i].srgb[k] >> (16 - 8 * c) & 0xff);
        return true;
    }
    return false;
}

void spec_palette_at(const double rgb[SPEC_PALETTE_POINTS][3], double place, double out[3])
{
    double x = place * (SPEC_PALETTE_POINTS - 1);
    int i = x < SPEC_PALETTE_POINTS - 2 ? (int)x : SPEC_PALETTE_POINTS - 2;
    for (int c = 0; c < 3; c++) out[c] = rgb[i][c] + (rgb[i + 1][c] - rgb[i][c]) * (x - i);
}
