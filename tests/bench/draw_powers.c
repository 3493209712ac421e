/* draw_powers SEED "SLOTS SPREAD": the powers that simulate -s SEED -j SLOTS,SPREAD draws */
#include "sim/sim.h"

#include <stdio.h>
#include <stdlib.h>

int main(int argc, char **argv)
{
    int slots;
    double spread;
    if (argc != 3 || sscanf(argv[2], "%d %lf", &slots, &spread) != 2 || slots < 1) return 2;
    double *power = sim_draw_powers(strtoull(argv[1], NULL, 10), slots, spread);
    for (int k = 0; k < slots; k++) printf("%s%.9g", k ? "," : "", power[k]);
    puts("");
    free(power);
}
