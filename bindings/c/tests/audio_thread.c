#define _POSIX_C_SOURCE 200809L
/* A game's thread and an audio thread: bodies and surfaces come and go, contacts slide, ports are read; the audio thread allocates and frees
 * nothing. Run with malloc_counter.so preloaded. */
#include "common.h"

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <time.h>

extern void malloc_counter_begin(void) __attribute__((weak));
extern long malloc_counter_end(void) __attribute__((weak));

static asp_renderer *renderer;
static asp_port *port;
static atomic_int stop;
static long allocations;
static double loudest;

static void *audio(void *unused) {
    (void)unused;
    float out[4 * 256], felt[64], planes[3][256];
    float *haptic[2] = {planes[0], planes[1]}, *bus[1] = {planes[2]};
    if (malloc_counter_begin)
        malloc_counter_begin();
    for (int i = 0; !atomic_load(&stop) || i < 200; i++) {
        if (i % 2)
            asp_render_interleaved(renderer, out, 4, 256, NULL);
        else
            asp_render(renderer, haptic, 2, bus, 1, 256);
        asp_report_load(renderer, 0.1f);
        while (asp_port_pcm(port, felt, 64))
            ;
        for (int s = 0; s < 256; s++)
            loudest = fmax(loudest, fabs((double)(i % 2 ? out[4 * s] : planes[2][s])));
    }
    if (malloc_counter_end)
        allocations = malloc_counter_end();
    return NULL;
}

int main(int count, char **words) {
    (void)words;
    int must_count = count == 1;
    MUST(asp_check() == ASP_OK && (!must_count || malloc_counter_begin));
    asp_config config;
    asp_config_init(&config);
    config.sample_rate_hz = 48000;
    config.haptic_channels = 2;
    asp_scene *scene;
    MUST(asp_build(&config, &scene, &renderer) == ASP_OK);
    asp_port_config wanted;
    asp_port_config_init(&wanted);
    MUST(asp_open_port(scene, &wanted, &port) == ASP_OK);
    pthread_t thread;
    MUST(pthread_create(&thread, NULL, audio, NULL) == 0);

    asp_body bell;
    asp_body_init(&bell);
    bell.stock = "bar";
    bell.size_m = 0.2;
    bell.material = ASP_MATERIAL_BRASS;
    uint64_t body, plane;
    MUST(asp_add_body(scene, &bell, &body) == ASP_OK);
    asp_surface surface;
    asp_surface_init(&surface);
    surface.width_m = surface.height_m = 0.2;
    surface.body = body;
    surface.table = "solid = \"granite\"";
    MUST(asp_add_surface(scene, &surface, &plane) == ASP_OK);
    int steps = must_count ? 300 : 40;
    struct timespec tick = {0, 3000000};
    for (int step = 0; step < steps; step++) {
        asp_event events[3];
        uint32_t taken;
        events[0] = step % 50 == 0 ? asp_begin(1, plane, 0, 0.001 * step, 0.5, 0.7) : asp_move(1, 0.001 * step, 0.5, 0.7);
        events[1] = step % 50 == 49 ? asp_end(1) : asp_move(1, 0.001 * step + 1e-6, 0.5, 0.7);
        events[2] = asp_impact(body, 0.3, 0.01, 0.005);
        MUST(asp_report(scene, step * 0.003, events, step % 10 == 0 ? 3 : 2, sizeof *events, &taken) == ASP_OK);
        if (step % 20 == 5)
            MUST(asp_replace_surface(scene, plane, &surface) == ASP_OK);
        if (step % 20 == 15) {
            uint64_t another;
            MUST(asp_add_body(scene, &bell, &another) == ASP_OK && asp_remove_body(scene, another) == ASP_OK);
        }
        nanosleep(&tick, NULL);
    }
    atomic_store(&stop, 1);
    MUST(pthread_join(thread, NULL) == 0);
    printf("audio thread: %ld allocations and frees, peak %.3f\n", allocations, loudest);
    MUST(allocations == 0 && loudest > 1e-6);
    MUST(asp_port_free(port) == ASP_OK && asp_scene_free(scene) == ASP_OK && asp_renderer_free(renderer) == ASP_OK);
    return 0;
}
