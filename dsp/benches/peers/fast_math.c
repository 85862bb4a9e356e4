// The honest peer of the modal bank: the loop a C programmer writes, with everything the compiler is allowed
// to do about it (gcc -O3 -march=native -ffast-math). Direct form in f32, modes in the inner loop, so that
// the compiler vectorises over modes; the sum over modes is reassociated by -ffast-math.
//
// Twice: as most write it (one gain a mode, so phase 0 only), and with the two gains that a mode with phase needs,
// which is what the bank computes.
//
//   fast_math MODES SEGMENTS [phase]      prints the best and the median of SEGMENTS timings, in mode-samples per ns
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define BLOCK 64

static void render(int modes, const float *restrict a1, const float *restrict a2, const float *restrict gain,
                   float *restrict y1, float *restrict y2, const float *restrict in, float *restrict out) {
    for (int n = 0; n < BLOCK; ++n) {
        float sum = 0.0f;
        for (int i = 0; i < modes; ++i) {
            float y = a1[i] * y1[i] + a2[i] * y2[i] + in[n];
            y2[i] = y1[i];
            y1[i] = y;
            sum += gain[i] * y;
        }
        out[n] = sum;
    }
}

static void render_phase(int modes, const float *restrict a1, const float *restrict a2, const float *restrict gain,
                         const float *restrict gain1, float *restrict y1, float *restrict y2,
                         const float *restrict in, float *restrict out) {
    for (int n = 0; n < BLOCK; ++n) {
        float sum = 0.0f;
        for (int i = 0; i < modes; ++i) {
            float y = a1[i] * y1[i] + a2[i] * y2[i] + in[n];
            sum += gain[i] * y + gain1[i] * y1[i];
            y2[i] = y1[i];
            y1[i] = y;
        }
        out[n] = sum;
    }
}

static double now_ns(void) {
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e9 * t.tv_sec + t.tv_nsec;
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

int main(int argc, char **argv) {
    int modes = argc > 1 ? atoi(argv[1]) : 256, segments = argc > 2 ? atoi(argv[2]) : 50, phase = argc > 3;
    float *a = aligned_alloc(64, 6 * (size_t)(modes + 16) * sizeof(float));
    float *a1 = a, *a2 = a + modes, *gain = a + 2 * modes, *y1 = a + 3 * modes, *y2 = a + 4 * modes, *gain1 = a + 5 * modes;
    float in[BLOCK], out[BLOCK];
    unsigned seed = 1;
    for (int i = 0; i < modes; ++i) {
        double theta = 2 * M_PI * (100.0 + 15000.0 * i / modes) / 44100.0, r = exp(-20.0 / 44100.0);
        a1[i] = 2 * r * cos(theta), a2[i] = -r * r, gain[i] = sin(theta) / modes, gain1[i] = 0.3f * gain[i], y1[i] = y2[i] = 0;
    }
    double *rates = malloc(sizeof(double) * segments), guard = 0;
    int blocks = 1 + 4000000 / (modes * BLOCK);
    for (int s = 0; s < segments; ++s) {
        for (int n = 0; n < BLOCK; ++n) seed = seed * 1664525u + 1013904223u, in[n] = (seed >> 8) * 6e-8f - 0.5f;
        double start = now_ns();
        for (int b = 0; b < blocks; ++b) {
            if (phase) render_phase(modes, a1, a2, gain, gain1, y1, y2, in, out);
            else render(modes, a1, a2, gain, y1, y2, in, out);
            in[b % BLOCK] += 1e-6f * out[(b + 1) % BLOCK];
        }
        rates[s] = (double)blocks * BLOCK * modes / (now_ns() - start);
        guard += out[BLOCK - 1];
    }
    qsort(rates, segments, sizeof(double), ascending);
    fprintf(stderr, "%g\n", guard);
    printf("%.3f %.3f\n", rates[segments - 1], rates[segments / 2]);
    return 0;
}
