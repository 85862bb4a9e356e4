#define _POSIX_C_SOURCE 200809L
/* torture BLOCKS: what hosts of plug-ins do. Two engines side by side, each a game's thread and two audio threads that take turns; blocks of 1
 * to 8192 frames, other rates while contacts sound, bodies and surfaces that come and go, a scene and then a renderer freed while the others
 * go on. For the address sanitizer: every sample is a number, and nothing is read that was freed. */
#include "common.h"

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <time.h>

#define MOST_FRAMES 8192
static const double RATES_HZ[] = {44100, 48000, 96000, 22050, 88200, 192000};

typedef struct host {
    asp_scene *scene;
    asp_renderer *renderer;
    pthread_mutex_t turn; /* whoever renders, or changes the rate, has it */
    atomic_int blocks, ends;
    int wanted;
    uint64_t seed;
    double loudest;
    long rates;
} host;

typedef struct voice {
    host *of;
    int odd;
} voice;

static uint32_t next(uint64_t *state, uint32_t below) {
    *state ^= *state << 13, *state ^= *state >> 7, *state ^= *state << 17;
    return (uint32_t)((*state >> 11) % below);
}

static void render(host *h, uint64_t *dice, float *out) {
    /* As often a handful of frames as thousands. */
    uint32_t frames = 1 + next(dice, next(dice, 2) ? MOST_FRAMES : 64), width = 1 + next(dice, 4);
    size_t heard = 0;
    if (next(dice, 2)) {
        asp_render_interleaved(h->renderer, out, width, frames, NULL);
        heard = (size_t)width * frames;
    } else {
        float *haptic[2] = {out, out + MOST_FRAMES}, *audio[2] = {out + 2 * MOST_FRAMES, NULL};
        memset(out, 0, 3 * MOST_FRAMES * sizeof *out);
        asp_render(h->renderer, haptic, 2, audio, 2, frames);
        heard = 3 * MOST_FRAMES;
    }
    for (size_t i = 0; i < heard; i++) {
        MUST(isfinite(out[i]));
        h->loudest = fmax(h->loudest, fabs((double)out[i]));
    }
    asp_report_load(h->renderer, next(dice, 30) ? 0.3f : 1.7f);
}

static void *audio(void *word) {
    voice *v = word;
    host *h = v->of;
    uint64_t dice = h->seed * 77 + (uint64_t)v->odd;
    float *out = malloc(4 * MOST_FRAMES * sizeof *out);
    while (!atomic_load(&h->ends)) {
        MUST(pthread_mutex_lock(&h->turn) == 0);
        if (atomic_load(&h->blocks) % 2 == v->odd)
            render(h, &dice, out), atomic_fetch_add(&h->blocks, 1);
        MUST(pthread_mutex_unlock(&h->turn) == 0);
    }
    free(out);
    return NULL;
}

static uint64_t bell_of(host *h, uint64_t *dice) {
    static const char *stocks[] = {"bar", "plate", "bowl", "tube"};
    asp_body bell;
    uint64_t id = 0;
    asp_body_init(&bell);
    bell.stock = stocks[next(dice, 4)], bell.size_m = 0.1 + 0.01 * next(dice, 20), bell.material = 1 + next(dice, 5);
    MUST(asp_add_body(h->scene, &bell, &id) == ASP_OK);
    return id;
}

static uint64_t plane_of(host *h, uint64_t *dice, uint64_t body) {
    asp_surface surface;
    uint64_t id = 0;
    asp_surface_init(&surface);
    surface.width_m = surface.height_m = 0.2, surface.body = body;
    surface.table = next(dice, 2) ? "solid = \"granite\"" : "solid = \"wood\"";
    MUST(asp_add_surface(h->scene, &surface, &id) == ASP_OK);
    return id;
}

static void report(host *h, uint64_t *dice, long step, uint64_t body, uint64_t plane) {
    asp_event events[4];
    uint32_t taken;
    for (uint32_t i = 0; i < 3; i++) {
        uint32_t what = next(dice, 10);
        double u = 0.001 * (double)(step % 1000);
        events[i] = what == 0 ? asp_begin(i, plane, 0, u, 0.5, 0.7) : what == 1 ? asp_end(i) : asp_move(i, u, 0.5, 0.7);
    }
    events[3] = asp_impact(body, 0.3, 0.01, 0.005);
    /* A full queue is an answer, too: the audio threads may be busy with thousands of frames. */
    int32_t told = asp_report(h->scene, (double)step * 0.003, events, step % 9 ? 3 : 4, sizeof *events, &taken);
    MUST(told != ASP_PANIC && told != ASP_BAD_HANDLE && told != ASP_BAD_ARGUMENT);
}

static void *game(void *word) {
    host *h = word;
    uint64_t dice = h->seed, body = bell_of(h, &dice), plane = plane_of(h, &dice, body);
    struct timespec tick = {0, 500000};
    for (long step = 0; atomic_load(&h->blocks) < h->wanted; step++) {
        report(h, &dice, step, body, plane);
        if (next(&dice, 40) == 0) {
            MUST(asp_remove_surface(h->scene, plane) == ASP_OK && asp_remove_body(h->scene, body) == ASP_OK);
            MUST(asp_collect(h->scene, NULL) <= ASP_OK);
            body = bell_of(h, &dice), plane = plane_of(h, &dice, body);
        }
        if (next(&dice, 60) == 0) {
            MUST(pthread_mutex_lock(&h->turn) == 0);
            MUST(asp_set_sample_rate(h->scene, h->renderer, RATES_HZ[next(&dice, 6)]) == ASP_OK);
            h->rates++;
            MUST(pthread_mutex_unlock(&h->turn) == 0);
        }
        nanosleep(&tick, NULL);
    }
    /* Unloaded while it plays: first what the game has, then what renders. */
    MUST(asp_scene_free(h->scene) == ASP_OK);
    for (int until = atomic_load(&h->blocks) + 6; atomic_load(&h->blocks) < until;)
        nanosleep(&tick, NULL);
    MUST(asp_renderer_free(h->renderer) == ASP_OK);
    for (int until = atomic_load(&h->blocks) + 6; atomic_load(&h->blocks) < until;)
        nanosleep(&tick, NULL);
    atomic_store(&h->ends, 1);
    return NULL;
}

int main(int count, char **words) {
    MUST(count == 2);
    static host hosts[2];
    static voice voices[4];
    pthread_t threads[6];
    for (int i = 0; i < 2; i++) {
        host *h = &hosts[i];
        asp_config config;
        asp_config_init(&config);
        config.haptic_channels = 2, config.sample_rate_hz = RATES_HZ[i];
        h->wanted = atoi(words[1]), h->seed = 0x9e3779b97f4a7c15u + (uint64_t)i;
        MUST(pthread_mutex_init(&h->turn, NULL) == 0 && asp_build(&config, &h->scene, &h->renderer) == ASP_OK);
        MUST(pthread_create(&threads[3 * i], NULL, game, h) == 0);
        for (int odd = 0; odd < 2; odd++) {
            voices[2 * i + odd] = (voice){h, odd};
            MUST(pthread_create(&threads[3 * i + 1 + odd], NULL, audio, &voices[2 * i + odd]) == 0);
        }
    }
    for (int i = 0; i < 6; i++)
        MUST(pthread_join(threads[i], NULL) == 0);
    for (int i = 0; i < 2; i++) {
        MUST(hosts[i].loudest > 1e-6 && hosts[i].rates > 0);
        printf("torture: %d blocks, %ld other rates, peak %.3f\n", atomic_load(&hosts[i].blocks), hosts[i].rates, hosts[i].loudest);
    }
    return 0;
}
