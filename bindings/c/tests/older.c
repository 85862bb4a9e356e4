/* A program that was compiled with the header of 0.1.0, whose event, statistics and body are shorter, goes on with this library: it is not
 * refused, nothing is written beyond its structs, and what they cannot say has its default. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* As 0.1.0 had them. */
typedef struct {
    uint32_t struct_size, kind;
    uint64_t contact, surface, body, other, holder, probe;
    int32_t actuator;
    uint32_t striker, position, reserved;
    double uv[2], velocity_m_s[2], normal_force_n, closing_m_s, depth_m, at_m[3], direction[3], gain, importance;
    double speed_m_s, mass_kg, radius_m, restitution, striker_young_pa, striker_poisson, striker_density_kg_m3;
} old_event;
typedef struct {
    uint32_t struct_size;
    float load;
    uint64_t counts[23];
} old_stats;
typedef struct {
    uint32_t struct_size, material, bus, mode_count;
    double gain;
    const char *name, *stock;
    double size_m;
    const void *modes;
    double impulse_n_s;
    const char *modes_json, *table;
    const void *files;
} old_body;
struct guarded_event { old_event it; uint64_t guard; };
struct guarded_stats { old_stats it; uint64_t guard; };
struct guarded_body { old_body it; uint64_t guard; };

int32_t asp_check_abi(uint32_t abi, const uint32_t *sizes, uint32_t count);
void asp_event_init(old_event *event);
void asp_stats_init(old_stats *stats);
void asp_body_init(old_body *body);
int32_t asp_load(const char *path, const char *text, const void *files, const void *config, void **scene, void **renderer);
int32_t asp_add_body(void *scene, const old_body *body, uint64_t *id);
int32_t asp_report(void *scene, double time_s, const old_event *events, uint32_t count, uint32_t size, uint32_t *taken);
int32_t asp_read_log(void *scene, const char *text, old_event *events, double *times_s, uint32_t capacity, uint32_t size, uint32_t *count);
int32_t asp_get_stats(void *scene, old_stats *stats);
void asp_render_interleaved(void *renderer, float *out, uint32_t channels, uint32_t frames, const int32_t *map);
int32_t asp_scene_free(void *scene);
int32_t asp_renderer_free(void *renderer);
const char *asp_last_error(void);

#define GUARD 0x5a5a5a5a5a5a5a5aULL
#define MUST(holds)                                                                                                    \
    do {                                                                                                               \
        if (!(holds)) {                                                                                                \
            fprintf(stderr, "%s:%d: %s does not hold; the library says: \"%s\"\n", __FILE__, __LINE__, #holds,      \
                    asp_last_error());                                                                                 \
            exit(1);                                                                                                   \
        }                                                                                                              \
    } while (0)

int main(void) {
    /* config, files, image, mode, body, surface, event, stats of 0.1.0. */
    const uint32_t sizes[] = {48, 24, 32, 32, sizeof(old_body), 168, sizeof(old_event), sizeof(old_stats)};
    MUST(sizeof(old_event) == 248 && sizeof(old_stats) == 192 && sizeof(old_body) == 88);
    MUST(asp_check_abi(1, sizes, 8) == 0);
    static const char scene_file[] = "[[body]]\nname = \"a\"\nstock = \"disc\"\nsize_m = 0.1\n[[surface]]\nname = \"b\"\nbody = \"a\"\n"
                                     "width_m = 0.1\nheight_m = 0.1\n";
    static const char log[] = "{\"t\":0,\"event\":\"begin\",\"contact\":1,\"surface\":\"b\",\"actuator\":0,\"uv\":[0,0],\"normal_force_n\":1,"
                              "\"slip_m_s\":0}\n{\"t\":0.02,\"event\":\"move\",\"contact\":1,\"uv\":[0.02,0],\"normal_force_n\":1}\n";
    void *scene, *renderer;
    MUST(asp_load("x.toml", scene_file, NULL, NULL, &scene, &renderer) == 0);

    struct guarded_body body = {.guard = GUARD};
    asp_body_init(&body.it);
    MUST(body.it.struct_size == sizeof body.it && body.it.gain == 1 && body.guard == GUARD);
    body.it.stock = "bowl", body.it.size_m = 0.1;
    uint64_t bowl;
    MUST(asp_add_body(scene, &body.it, &bowl) == 0);

    struct guarded_event one = {.guard = GUARD};
    asp_event_init(&one.it);
    MUST(one.it.struct_size == sizeof one.it && one.it.actuator == -1 && isnan(one.it.striker_density_kg_m3) && one.guard == GUARD);

    /* A log's events, one after another in the old stride. */
    struct { old_event events[2]; uint64_t guard; } read = {.guard = GUARD};
    double times_s[2];
    uint32_t count;
    MUST(asp_read_log(scene, log, read.events, times_s, 2, sizeof(old_event), &count) == 0 && count == 2 && read.guard == GUARD);
    MUST(read.events[0].kind == 1 && read.events[1].kind == 2 && read.events[1].uv[0] == 0.02 && times_s[1] == 0.02);
    uint32_t taken;
    MUST(asp_report(scene, 0.0, read.events, 2, sizeof(old_event), &taken) == 0 && taken == 2);
    one.it.kind = 4, one.it.body = bowl;
    MUST(asp_report(scene, 0.03, &one.it, 1, sizeof one.it, &taken) == 0 && taken == 1);
    /* An event that says it is longer than the room between two is refused, not read. */
    one.it.struct_size += 16;
    MUST(asp_report(scene, 0.04, &one.it, 1, sizeof one.it, &taken) != 0 && taken == 0 && strstr(asp_last_error(), "struct_size"));

    float block[2 * 4096], peak = 0;
    asp_render_interleaved(renderer, block, 2, 4096, NULL);
    for (int i = 0; i < 2 * 4096; i++)
        peak = fabsf(block[i]) > peak ? fabsf(block[i]) : peak;
    struct guarded_stats stats = {.guard = GUARD};
    asp_stats_init(&stats.it);
    MUST(stats.it.struct_size == sizeof stats.it && asp_get_stats(scene, &stats.it) == 0 && stats.guard == GUARD);
    MUST(peak > 0 && stats.it.counts[0] == 4096 && stats.it.counts[2] == 1);
    MUST(asp_scene_free(scene) == 0 && asp_renderer_free(renderer) == 0);
    printf("a program of 0.1.0 goes on: peak %g\n", (double)peak);
    return 0;
}
