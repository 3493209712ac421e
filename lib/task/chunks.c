/*
 * Cuts whose tasks get smaller towards the end: few tasks while much work is left, small ones when
 * all slots should finish together.
 *
 * guided     a chunk is the rest divided by the slots (C. D. Polychronopoulos, D. J. Kuck,
 *            "Guided self-scheduling: a practical scheduling scheme for parallel supercomputers",
 *            IEEE Trans. Computers C-36(12), 1987)
 * factoring  a batch is half of the rest, in one chunk per slot (S. F. Hummel, E. Schonberg,
 *            L. E. Flynn, "Factoring: a method for scheduling parallel loops", Comm. ACM 35(8),
 *            1992)
 *
 * Weighted factoring (S. F. Hummel, J. Schmidt, R. N. Uma, J. Wein, "Load-sharing in heterogeneous
 * systems via weighted factoring", SPAA 1996) sizes chunks of a batch by the power of slots.
 * Differs in that only the first batch is cut by power, because the slot that will take a chunk is
 * not known here. Chunks of later batches have the size that suits the weakest slot.
 */
#include "task/task.h"

#include <stdlib.h>

static void add_chunk(struct cut *cut, uint32_t *left, double size)
{
    uint32_t n = size < 1 ? 1 : size > *left ? *left : (uint32_t)ceil(size);
    uint32_t start = cut->n ? cut->ends[cut->n - 1] : 0;
    cut->ends = xgrown(cut->ends, cut->n, sizeof *cut->ends);
    cut->ends[cut->n++] = start + n;
    *left -= n;
}

/* Half of the rest, in n chunks. */
static void add_batch(struct cut *cut, uint32_t *left, double n)
{
    double size = *left / 2. / n;
    for (int k = 0; k < n && *left; k++) add_chunk(cut, left, size);
}

void cut_chunks(struct cut *cut, uint32_t frame_w, uint32_t frame_h, const double *power, int slots)
{
    uint64_t pixels = (uint64_t)frame_w * frame_h;
    uint32_t left = cut->w ? (uint32_t)((pixels + cut->w - 1) / cut->w) : frame_h, all = left;
    double sum = 0, least = HUGE_VAL;
    for (int k = 0; k < slots; k++) {
        sum += power ? power[k] : 1;
        least = fmin(least, power ? power[k] : 1);
    }
    for (int k = 0; power && k < slots && left; k++)
        add_chunk(cut, &left, all / 2. * power[k] / sum);
    while (left) {
        if (cut->unit == CUT_GUIDED) add_chunk(cut, &left, (double)left / slots);
        else add_batch(cut, &left, sum / least);
    }
}

void cut_free(struct cut *cut)
{
    free(cut->ends);
    cut->ends = NULL;
    cut->n = 0;
}

struct lattice chunk_at(const struct cut *cut, uint32_t frame_w, uint32_t frame_h, uint32_t id)
{
    uint32_t start = id ? cut->ends[id - 1] : 0, n = cut->ends[id] - start;
    if (!cut->w) return (struct lattice){0, start, frame_w, n, 1, 1};
    uint64_t first = (uint64_t)start * cut->w, end = (uint64_t)cut->ends[id] * cut->w;
    uint64_t pixels = (uint64_t)frame_w * frame_h;
    if (end > pixels) end = pixels;
    return (struct lattice){
        (uint32_t)(first % frame_w), (uint32_t)(first / frame_w), (uint32_t)(end - first), 1, 1, 1};
}
