/* A ceramic plate is struck and stroked for two seconds; what is heard and felt becomes stroke.wav. */
#include <asperity.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define RATE 48000
#define TICKS 120 /* of a physics engine at 60 Hz */
#define FRAMES (RATE / 60)

static void need(int32_t status) {
    if (status != ASP_OK) {
        fprintf(stderr, "error: %s\n", asp_last_error());
        exit(1);
    }
}

static void put32(FILE *file, uint32_t value) { fwrite(&value, 4, 1, file); }

int main(void) {
    need(asp_check());

    /* An engine: one half for the game, one for the audio thread. */
    asp_config config;
    asp_config_init(&config);
    config.sample_rate_hz = RATE;
    config.more = "audio = [{ gain = 0.2, limit = true }]";
    config.clock = ASP_CLOCK_EXACT; /* rendered to a file; a game that runs now keeps the default, ASP_CLOCK_LIVE */
    asp_scene *scene;
    asp_renderer *renderer;
    need(asp_build(&config, &scene, &renderer));

    /* A plate of 14 cm that rings, and its top, 1 mm bumps, which is touched. */
    asp_body plate;
    asp_body_init(&plate);
    plate.stock = "plate";
    plate.size_m = 0.14;
    plate.material = ASP_MATERIAL_CERAMIC;
    uint64_t body, surface;
    need(asp_add_body(scene, &plate, &body));

    static float heights[8 * 8];
    for (int i = 0; i < 64; i++)
        heights[i] = (float)(2e-5 * sin(i % 8 * 0.7853981633974483) * sin(i / 8 * 0.7853981633974483));
    asp_surface top;
    asp_surface_init(&top);
    top.width_m = top.height_m = 0.004; /* repeats every 4 mm */
    top.relief_m = 1.0;                 /* heights are metres */
    top.heights.samples = heights;
    top.heights.width = top.heights.height = 8;
    top.heights.format = ASP_F32;
    top.body = body;
    need(asp_add_surface(scene, &top, &surface));

    FILE *file = fopen("stroke.wav", "wb");
    if (!file)
        return perror("stroke.wav"), 1;
    uint32_t bytes = TICKS * FRAMES * 2 * 4;
    fwrite("RIFF", 4, 1, file), put32(file, 36 + bytes), fwrite("WAVEfmt ", 8, 1, file), put32(file, 16);
    put32(file, 3 | 2 << 16), put32(file, RATE), put32(file, RATE * 8), put32(file, 8 | 32 << 16);
    fwrite("data", 4, 1, file), put32(file, bytes);

    for (int tick = 0; tick < TICKS; tick++) {
        /* The game's thread: one call a physics step. */
        double time_s = tick / 60.0, u = 25.0 * time_s; /* 0.1 m/s */
        asp_event events[2];
        uint32_t count = 0;
        if (tick == 0) {
            events[count++] = asp_begin(1, surface, 0, u, 0.5, 0.6);
            events[count++] = asp_impact(body, 0.5, 0.01, 0.005);
        } else {
            events[count++] = tick < TICKS - 30 ? asp_move(1, u, 0.5, 0.6) : asp_end(1);
        }
        if (tick <= TICKS - 30)
            need(asp_report(scene, time_s, events, count, sizeof *events, NULL));

        /* The audio thread: sound on channel 0, what the finger feels on channel 1. */
        static float block[FRAMES * 2];
        const int32_t map[2] = {0, ASP_HAPTIC + 0};
        asp_render_interleaved(renderer, block, 2, FRAMES, map);
        fwrite(block, sizeof block, 1, file);
    }
    fclose(file);
    char why[1000];
    need(asp_why_silent(scene, why, sizeof why));
    printf("stroke.wav is written. %s\n", why);
    asp_scene_free(scene);
    asp_renderer_free(renderer);
    return 0;
}
