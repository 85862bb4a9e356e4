// Times the C code that Faust generates for faust_bank.dsp, force in every sample: the best of many segments, in
// mode-samples a nanosecond. MODES and GENERATED come from run.sh. With RESPONSE defined, writes that many samples of
// the impulse response instead, raw f32.
#define FAUSTFLOAT float
#include <faust/gui/CInterface.h>
#include GENERATED
#include <stdio.h>
#include <time.h>

#define BLOCK 64

static double now_ns(void) {
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e9 * t.tv_sec + t.tv_nsec;
}

int main(void) {
    mydsp *bank = newmydsp();
    initmydsp(bank, 44100);
    float in[BLOCK], out[BLOCK];
    float *inputs[] = {in}, *outputs[] = {out};
#ifdef RESPONSE
    for (long n = 0; n < RESPONSE; n += BLOCK) {
        for (int i = 0; i < BLOCK; ++i) in[i] = n + i == 0;
        computemydsp(bank, BLOCK, inputs, outputs);
        fwrite(out, sizeof *out, BLOCK, stdout);
    }
    return 0;
#endif
    unsigned seed = 1;
    double best = 0;
    int blocks = 1 + 2000000 / (MODES * BLOCK);
    for (int segment = 0; segment < 60; ++segment) {
        for (int n = 0; n < BLOCK; ++n) seed = seed * 1664525u + 1013904223u, in[n] = (seed >> 8) * 6e-8f - 0.5f;
        double start = now_ns();
        for (int b = 0; b < blocks; ++b) {
            computemydsp(bank, BLOCK, inputs, outputs);
            in[b % BLOCK] += 1e-6f * out[(b + 1) % BLOCK];
        }
        double rate = (double)blocks * BLOCK * MODES / (now_ns() - start);
        if (rate > best) best = rate;
    }
    printf("%.3f\n", best);
    return 0;
}
