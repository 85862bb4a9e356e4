/* Pickups and pairs of colliders through the header: a tap is read by its factors, gravity by an accelerometer, a stroke by the rules of pairs,
 * and what is wrong is refused in a sentence. That a reading is that of `asperity render` is shown by replay.c. */
#include "common.h"

#include <math.h>

enum { FRAMES = 4096, CHANNELS = 3 };

static float read[CHANNELS][FRAMES];

static void render(asp_renderer *renderer) {
    float *planes[CHANNELS] = {read[0], read[1], read[2]};
    asp_pickup_render(renderer, NULL, 0, NULL, 0, planes, CHANNELS, FRAMES);
}

static float peak(const float *samples) {
    float most = 0;
    for (int i = 0; i < FRAMES; i++)
        most = fabsf(samples[i]) > most ? fabsf(samples[i]) : most;
    return most;
}

static void build(asp_scene **scene, asp_renderer **renderer, uint64_t *body) {
    asp_config config;
    asp_config_init(&config);
    config.clock = ASP_CLOCK_EXACT;
    config.pickup_channels = CHANNELS;
    MUST(asp_build(&config, scene, renderer) == ASP_OK);
    asp_body plate;
    asp_body_init(&plate);
    plate.stock = "plate", plate.size_m = 0.3, plate.material = ASP_MATERIAL_WOOD;
    MUST(asp_add_body(*scene, &plate, body) == ASP_OK);
}

static void put(asp_scene *scene, uint64_t body, uint32_t channel, uint32_t quantity, double factor) {
    asp_pickup pickup;
    asp_pickup_init(&pickup);
    pickup.channel = channel, pickup.quantity = quantity, pickup.factor = factor;
    MUST(asp_pickup_add(scene, body, &pickup) == ASP_OK);
}

static void reads_a_tap(void) {
    asp_scene *scene;
    asp_renderer *renderer;
    uint64_t body;
    build(&scene, &renderer, &body);
    put(scene, body, 0, ASP_PICKUP_ACCELERATION, 1.0);
    put(scene, body, 1, ASP_PICKUP_ACCELERATION, -0.5);
    put(scene, body, 2, ASP_PICKUP_VELOCITY, 1.0);
    uint32_t channels;
    MUST(asp_pickup_channels(renderer, &channels) == ASP_OK && channels == CHANNELS);
    asp_event tap = asp_impact(body, 1.0, 0.004, 0.005);
    MUST(asp_report(scene, 0.0, &tap, 1, sizeof tap, NULL) == ASP_OK);
    render(renderer);
    float most = peak(read[0]);
    MUST(most > 1 && peak(read[2]) > 0 && peak(read[2]) < 0.1F * most);
    for (int i = 0; i < FRAMES; i++)
        MUST(fabsf(read[0][i] + 2 * read[1][i]) <= 1e-5F * most);

    /* In its own axes: at rest it is held up against gravity. */
    asp_motion rest = {.gravity_m_s2 = {0, 0, -9.81}};
    MUST(asp_pickup_motion(scene, 0.2, body, &rest) == ASP_OK && asp_pickup_motion(scene, 0.21, body, &rest) == ASP_OK);
    for (int block = 0; block < 40; block++)
        render(renderer);
    MUST(fabsf(read[0][FRAMES - 1] - 9.81F) < 0.02F && fabsf(read[2][FRAMES - 1]) < 1e-3F);

    asp_pickup wrong;
    asp_pickup_init(&wrong);
    MUST(asp_pickup_add(scene, body, &wrong) == ASP_REFUSED && strstr(asp_last_error(), "factor"));
    wrong.factor = 1, wrong.channel = CHANNELS;
    MUST(asp_pickup_add(scene, body, &wrong) == ASP_REFUSED && strstr(asp_last_error(), "channel: 3"));
    wrong.channel = 0, wrong.quantity = 3;
    MUST(asp_pickup_add(scene, body, &wrong) == ASP_BAD_ARGUMENT && strstr(asp_last_error(), "quantity: 3"));
    wrong.quantity = 0, wrong.struct_size += 8;
    MUST(asp_pickup_add(scene, body, &wrong) == ASP_BAD_ARGUMENT && strstr(asp_last_error(), "struct_size"));
    wrong.struct_size -= 8;
    MUST(asp_pickup_add(scene, 77, &wrong) == ASP_UNKNOWN && asp_pickup_add(scene, body, NULL) == ASP_BAD_ARGUMENT);
    rest.gravity_m_s2[1] = NAN;
    MUST(asp_pickup_motion(scene, 1.0, body, &rest) == ASP_REFUSED && strstr(asp_last_error(), "gravity_m_s2"));
    MUST(asp_scene_free(scene) == ASP_OK && asp_renderer_free(renderer) == ASP_OK);
}

static void hears_what_slides(void) {
    asp_scene *scene;
    asp_renderer *renderer;
    asp_pairs *pairs;
    uint64_t body;
    build(&scene, &renderer, &body);
    put(scene, body, 0, ASP_PICKUP_ACCELERATION, 1.0);
    MUST(asp_pairs_new(scene, &pairs) == ASP_OK);
    asp_surface top;
    asp_surface_init(&top);
    top.width_m = top.height_m = 0.2, top.body = body;
    asp_collider table, ball;
    asp_collider_init(&table), asp_collider_init(&ball);
    MUST(asp_add_surface(scene, &top, &table.surface) == ASP_OK);
    table.body = body, table.material = ASP_MATERIAL_WOOD, table.surface_m[0] = table.surface_m[1] = 0.2;
    ball.material = ASP_MATERIAL_STEEL, ball.form = ASP_FORM_SPHERE, ball.radius_m = 0.008, ball.mass_kg = 0.05;
    uint32_t index[2], events, all = 0;
    MUST(asp_pairs_add(pairs, &table, &index[0]) == ASP_OK && asp_pairs_add(pairs, &ball, &index[1]) == ASP_OK);
    MUST(index[0] == 0 && index[1] == 1);
    asp_placed placed[2] = {{.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}}, {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}}};
    asp_touch touch = {.colliders = {0, 1}, .normal = {0, 0, 1}, .force_n = 0.6};
    placed[1].place_m[2] = 0.008;
    /* It rests, slides for 60 ms, and is lifted. */
    for (int step = 0; step < 61; step++) {
        double slides = step >= 30 ? 0.15 : 0.0;
        placed[1].velocity_m_s[0] = slides, placed[1].place_m[0] += 0.002 * slides, touch.point_m[0] = placed[1].place_m[0];
        MUST(asp_pairs_step(pairs, scene, 0.002 * step, 0.002, placed, &touch, step < 60, &events) == ASP_OK);
        MUST(step >= 30 || events == 0);
        all += events;
    }
    MUST(all >= 31 && all <= 34);
    for (int block = 0; block < 2; block++) {
        render(renderer);
        /* 60 ms are 2646 samples. */
        for (int i = 0; block == 0 && i < 2600; i++)
            MUST(read[0][i] == 0);
        MUST(peak(read[0]) > 0.1F);
    }
    MUST(asp_pairs_step(pairs, scene, 0.1, 0.002, placed, &touch, 1, NULL) == ASP_BAD_ARGUMENT && strstr(asp_last_error(), "time_s"));
    touch.colliders[1] = 2;
    MUST(asp_pairs_step(pairs, scene, 0.2, 0.002, placed, &touch, 1, NULL) == ASP_BAD_ARGUMENT && strstr(asp_last_error(), "touch 0"));
    touch.colliders[1] = 1, placed[1].place_m[0] = NAN;
    MUST(asp_pairs_step(pairs, scene, 0.2, 0.002, placed, &touch, 1, NULL) == ASP_BAD_ARGUMENT && strstr(asp_last_error(), "placed 1"));
    placed[1].place_m[0] = 0, ball.form = 9;
    MUST(asp_pairs_add(pairs, &ball, &index[0]) == ASP_BAD_ARGUMENT && strstr(asp_last_error(), "form: 9"));
    MUST(asp_pairs_step(pairs, scene, 0.2, 0.002, placed, &touch, 1, NULL) == ASP_OK);
    MUST(asp_pairs_free(pairs) == ASP_OK && asp_pairs_free(pairs) == ASP_BAD_HANDLE && asp_pairs_free(NULL) == ASP_OK);
    MUST(asp_scene_free(scene) == ASP_OK && asp_renderer_free(renderer) == ASP_OK);
}

int main(void) {
    MUST(asp_check() == ASP_OK);
    reads_a_tap();
    hears_what_slides();
    puts("pickups: ok");
    return 0;
}
