/* fuzz SEED SEQUENCES: random sequences of calls with valid, stale, foreign and made-up handles, ids, numbers, sizes and texts. Nothing may
 * crash, every status that is not 0 has a sentence, and every sample is a finite number. For the address sanitizer and valgrind. */
#include "common.h"

#include <math.h>

static uint64_t state;

#ifdef BYTES_OF_A_FUZZER
/* The dice are a fuzzer's bytes, as long as there are any. */
static const uint8_t *dice;
static size_t dice_left;
#endif

static uint32_t rnd(uint32_t below) {
#ifdef BYTES_OF_A_FUZZER
    if (dice_left >= 2) {
        uint32_t word = dice[0] | (uint32_t)dice[1] << 8;
        dice += 2, dice_left -= 2;
        return word % below;
    }
#endif
    state ^= state << 13, state ^= state >> 7, state ^= state << 17;
    return (uint32_t)((state >> 11) % below);
}

static double number(void) {
    static const double odd[] = {NAN, INFINITY, -INFINITY, 0, -0.0, -1, 1e300, -1e300, 1e-300, 1e9, 4294967296.0, 0.5, 1};
    switch (rnd(4)) {
    case 0:
        return odd[rnd(sizeof odd / sizeof *odd)];
    case 1:
        return exp((rnd(2000) / 1000.0 - 1.0) * 14.0);
    default:
        return rnd(1000) / 1000.0;
    }
}

static const char *text(void) {
    static const char *texts[] = {NULL, "", "a", "b", "stylus", "preset = \"stylus\"", "solid = \"granite\"", "\xff", "[[[", "modes = \"x\"",
        "solid = \"wood\"\nwidth_m = 0.1\nheight_m = 0.2", "stock = \"bar\"\nsize_m = 0.2", "max_contacts = 2\nqueue_capacity = 8",
        "{\"format\":\"asperity.modes\",\"version\":1,\"modes\":[{\"frequency_hz\":400,\"decay_per_s\":3,\"amplitude\":1}]}",
        "[[body]]\nname = \"a\"\nstock = \"disc\"\nsize_m = 0.1\n[[surface]]\nname = \"b\"\nbody = \"a\"\nwidth_m = 0.1\nheight_m = 0.1\n",
        "{\"t\":0,\"event\":\"begin\",\"contact\":1,\"surface\":\"b\",\"actuator\":0,\"uv\":[0,0],\"normal_force_n\":1}\n{\"t\":1,\"event\":\"end\",\"contact\":1}",
        "brownian = { hurst = 0.5, rms_m = 1e-5, cells = 64 }", "compliance_m_n = 0.001", "nowhere/at/all.toml", "audio=0,1 haptic=2,3"};
    return texts[rnd(sizeof texts / sizeof *texts)];
}

static uint32_t size_of(size_t right) {
    /* The right one, that of an older header, where the struct has grown, or nonsense. */
    return rnd(8) ? (uint32_t)right : (rnd(3) ? (uint32_t)right - 8 * rnd(3) : rnd(2) ? rnd(300) : UINT32_MAX - rnd(3));
}

#define POOL 8
static asp_scene *scenes[POOL];
static asp_renderer *renderers[POOL];
static asp_port *ports[POOL];
static asp_player *players[POOL];
static uint64_t ids[2 * POOL];
static long calls, refusals;

/* A handle of the pool, or one of another kind, or nonsense. */
static void *any(void) {
    switch (rnd(12)) {
    case 0:
        return (void *)(uintptr_t)rnd(100000);
    case 1:
        return NULL;
    case 2:
        return ports[rnd(POOL)];
    case 3:
        return players[rnd(POOL)];
    case 4:
        return renderers[rnd(POOL)];
    default:
        return scenes[rnd(POOL)];
    }
}
static asp_scene *scene(void) { return rnd(10) ? scenes[rnd(POOL)] : (asp_scene *)any(); }
static asp_renderer *renderer(void) { return rnd(10) ? renderers[rnd(POOL)] : (asp_renderer *)any(); }
static asp_port *port(void) { return rnd(10) ? ports[rnd(POOL)] : (asp_port *)any(); }
static uint64_t id(void) { return rnd(10) ? ids[rnd(2 * POOL)] : (uint64_t)rnd(1000) << rnd(50); }

static void told(int32_t status) {
    calls++;
    refusals += status != ASP_OK;
    MUST(status <= 0 && status >= ASP_PANIC && status != ASP_PANIC && (status == ASP_OK) == (asp_last_error()[0] == 0));
}

static int32_t read_file(void *user, const char *path, asp_sink *sink) {
    static const uint8_t bytes[] = "[[surface]]\nname = \"s\"\nwidth_m = 0.1\nheight_m = 0.1\n";
    static const uint8_t grey[16] = {0, 50, 100, 150, 200, 250, 255, 5, 6, 7, 8, 9, 10, 11, 12, 13};
    asp_image image = {grey, 0, 4, 4, ASP_U8, 1};
    MUST(user == (void *)ids && path);
    if (rnd(3) == 0)
        return (int32_t)rnd(3);
    if (rnd(2))
        told(asp_sink_bytes(rnd(9) ? sink : NULL, bytes, rnd(9) ? sizeof bytes - 1 : 0));
    else
        told(asp_sink_picture(sink, &image));
    if (rnd(10) == 0)
        told(asp_scene_free(NULL));
    return 0;
}

static void make(void) {
    uint32_t at = rnd(POOL);
    asp_config config;
    asp_config_init(&config);
    config.struct_size = size_of(sizeof config);
    config.clock = rnd(4), config.kernel = rnd(12) ? rnd(2) : rnd(9);
    config.sample_rate_hz = rnd(3) ? 0 : 8000.0 + rnd(90000);
    config.haptic_channels = rnd(6) ? rnd(4) : rnd(100), config.audio_buses = rnd(6) ? rnd(4) : rnd(100);
    config.pickup_channels = rnd(6) ? rnd(4) : rnd(100), config.more = rnd(3) ? NULL : text();
    asp_files files;
    asp_files_init(&files);
    files.read = read_file, files.user = ids;
    told(asp_scene_free(scenes[at]));
    asp_renderer_free(renderers[at]);
    if (rnd(2)) {
        told(asp_build(&config, &scenes[at], &renderers[at]));
    } else {
        config.haptic_channels = config.audio_buses = config.pickup_channels = 0, config.more = NULL;
        told(asp_load("a/b.toml", rnd(3) ? text() : NULL, rnd(2) ? &files : NULL, &config, &scenes[at], &renderers[at]));
    }
}

static void body_or_surface(void) {
    static const float heights[16] = {0, 1e-5f, 2e-5f, 0, 1e-5f, 3e-5f, 0, 0, 1e-5f, 0, 0, 0, 2e-5f, 0, 0, 1e-5f};
    asp_mode modes[3] = {{300 + number(), 3, 1, 0}, {number(), number(), number(), number()}, {900, 5, 0.5, 0}};
    asp_files files;
    asp_files_init(&files);
    files.read = read_file, files.user = ids;
    uint64_t *to = &ids[rnd(2 * POOL)];
    if (rnd(2)) {
        asp_body body;
        asp_body_init(&body);
        body.struct_size = size_of(sizeof body), body.material = rnd(20), body.bus = rnd(4), body.name = text();
        body.gain = rnd(3) ? 1 : number(), body.impulse_n_s = rnd(2) ? 0.01 : number();
        if (rnd(2))
            body.modes = modes, body.mode_count = rnd(4);
        else if (rnd(2))
            body.stock = rnd(5) ? "bar" : text(), body.size_m = rnd(3) ? 0.2 : number();
        else
            body.modes_json = text();
        body.table = rnd(4) ? NULL : text(), body.files = rnd(2) ? &files : NULL, body.strike_gain = rnd(3) ? NAN : number();
        told(rnd(3) ? asp_add_body(scene(), &body, to) : asp_replace_body(scene(), id(), &body));
        return;
    }
    asp_surface surface;
    asp_surface_init(&surface);
    surface.struct_size = size_of(sizeof surface), surface.wrap = rnd(8) ? rnd(3) : rnd(99), surface.name = text();
    surface.width_m = rnd(6) ? 0.1 : number(), surface.height_m = rnd(6) ? 0.1 : number();
    surface.body = rnd(2) ? 0 : id(), surface.table = rnd(2) ? NULL : text(), surface.files = rnd(2) ? &files : NULL;
    if (rnd(2)) {
        surface.heights.samples = heights, surface.heights.width = surface.heights.height = rnd(8) ? 4 : rnd(5);
        surface.heights.format = ASP_F32, surface.relief_m = rnd(5) ? 1 : number();
    }
    surface.roughness = rnd(3) ? NAN : number(), surface.micro_relief_m = rnd(3) ? NAN : number() * 1e-5;
    surface.friction = rnd(3) ? NAN : number(), surface.compliance_m_n = rnd(3) ? NAN : number();
    told(rnd(3) ? asp_add_surface(scene(), &surface, to) : asp_replace_surface(scene(), id(), &surface));
}

static void report(void) {
    asp_event events[6];
    uint32_t count = rnd(7), taken = 0;
    for (uint32_t i = 0; i < 6; i++) {
        asp_event *e = &events[i];
        asp_event_init(e);
        e->kind = rnd(20) ? 1 + rnd(4) : rnd(200), e->struct_size = size_of(sizeof *e) == sizeof *e || rnd(8) ? (uint32_t)sizeof *e : rnd(99);
        e->contact = rnd(4), e->surface = id(), e->body = id(), e->other = rnd(3) ? 0 : id(), e->holder = rnd(3) ? 0 : id();
        e->probe = rnd(3) ? 0 : id(), e->actuator = (int32_t)rnd(4) - 1, e->striker = rnd(20), e->position = rnd(3);
        e->uv[0] = number(), e->uv[1] = number(), e->normal_force_n = rnd(2) ? 0.5 : number(), e->closing_m_s = rnd(2) ? 0 : number();
        if (rnd(3) == 0)
            e->velocity_m_s[0] = number(), e->velocity_m_s[1] = number();
        if (rnd(6) == 0)
            e->at_m[0] = number(), e->at_m[1] = number(), e->at_m[2] = number();
        if (rnd(6) == 0)
            e->depth_m = number();
        if (rnd(6) == 0)
            e->direction[0] = number(), e->direction[1] = number(), e->direction[2] = number();
        if (rnd(4) == 0)
            e->gain = number(), e->importance = number();
        if (rnd(4) == 0)
            e->slip_m_s = number(), e->roll_radius_m = rnd(2) ? NAN : number();
        if (rnd(3) == 0)
            e->speed_m_s = number(), e->mass_kg = number(), e->radius_m = number(), e->restitution = number();
        if (rnd(9) == 0)
            e->striker = ASP_MATERIAL_CUSTOM, e->striker_young_pa = number(), e->striker_poisson = 0.3, e->striker_density_kg_m3 = number();
    }
    told(asp_report(scene(), rnd(9) ? calls * 1e-3 : number(), events, count, size_of(sizeof *events), &taken));
    MUST(taken <= count);
}

static void render(void) {
    static float out[6 * 700];
    float *planes[6];
    uint32_t frames = rnd(700), width = 1 + rnd(6);
    asp_renderer *r = renderer();
    memset(out, 0x55, sizeof out);
    if (rnd(2)) {
        int32_t map[6] = {0, ASP_SILENT, ASP_HAPTIC, ASP_HAPTIC + 1, 1, (int32_t)rnd(3000) - 1500};
        asp_render_interleaved(r, out, width, frames, rnd(2) ? map : NULL);
        for (uint32_t i = 0; i < width * frames; i++)
            MUST(isfinite(out[i]));
    } else {
        for (uint32_t i = 0; i < 6; i++)
            planes[i] = rnd(5) ? out + 700 * rnd(6) : NULL; /* the same one twice, too */
        asp_render(r, planes, rnd(4), planes + 3, rnd(4), frames);
    }
    asp_report_load(r, (float)number());
    calls++;
}

static void ports_and_players(void) {
    float samples[50], f = (float)number();
    asp_point points[5];
    asp_force forces[5];
    double heavy, light;
    uint32_t at = rnd(POOL);
    switch (rnd(6)) {
    case 0: {
        asp_port_config config;
        asp_port_config_init(&config);
        config.kind = rnd(6), config.feed = rnd(3), config.index = rnd(3), config.rate_hz = rnd(3) ? 100 : number();
        config.holds_s = rnd(3) ? 0.1 : number() * 0.1, config.low_hz = rnd(3) ? 50 : number(), config.strongest = rnd(2);
        config.struct_size = size_of(sizeof config);
        asp_port_free(ports[at]);
        told(asp_open_port(scene(), &config, &ports[at]));
        break;
    }
    case 1: {
        asp_player_config config;
        asp_player_config_init(&config);
        config.silent = 1, config.block_frames = rnd(3) ? rnd(1000) : rnd(99999), config.channels = text();
        config.struct_size = size_of(sizeof config);
        asp_player_stop(players[at], NULL);
        told(asp_play(renderer(), &config, &players[at]));
        break;
    }
    case 2: {
        asp_player_report report;
        char words[20];
        asp_player_report_init(&report);
        told(asp_get_player_report(players[at], &report)), told(asp_player_device(players[at], words, rnd(21)));
        break;
    }
    default:
        MUST(asp_port_pcm(port(), samples, 50) <= 50 && asp_port_points(port(), points, 5) <= 5);
        MUST(asp_port_forces(port(), forces, 5) <= 5);
        asp_port_levels(port(), &heavy, &light), asp_port_lost(port());
        MUST(isfinite(heavy) && isfinite(light));
    }
    (void)f;
}

/* A pickup, a motion, and a world of pairs that takes three steps. */
static void pickups(void) {
    asp_pickup pickup;
    asp_pickup_init(&pickup);
    pickup.struct_size = size_of(sizeof pickup), pickup.channel = rnd(5), pickup.quantity = rnd(4);
    pickup.factor = rnd(2) ? 1 : number(), pickup.at_m[0] = rnd(3) ? NAN : number(), pickup.direction[2] = rnd(3) ? NAN : number();
    told(asp_pickup_add(scene(), id(), rnd(9) ? &pickup : NULL));
    asp_motion motion = {{number(), 0, 0}, {0, 0, -9.81}, {0, number(), 0}, {0, 0, number()}};
    told(asp_pickup_motion(scene(), number(), id(), &motion));
    uint32_t channels, index, events;
    float read[2][600], *planes[3] = {read[0], NULL, read[1]};
    asp_renderer *at = renderer();
    told(asp_pickup_channels(at, rnd(9) ? &channels : NULL));
    memset(read, 0, sizeof read);
    asp_pickup_render(at, NULL, rnd(70), NULL, rnd(3), planes, rnd(20) ? rnd(4) : 100, rnd(600));
    for (int i = 0; i < 1200; i++)
        MUST(isfinite(read[i / 600][i % 600]));
    asp_scene *heard = scene();
    asp_pairs *pairs = NULL;
    told(asp_pairs_new(heard, rnd(9) ? &pairs : NULL));
    asp_collider collider;
    asp_collider_init(&collider);
    collider.struct_size = size_of(sizeof collider), collider.material = rnd(20), collider.form = rnd(5), collider.body = id();
    collider.surface = id(), collider.mass_kg = rnd(2) ? 0.1 : number(), collider.radius_m = rnd(2) ? 0.01 : number();
    told(asp_pairs_add(pairs, &collider, &index));
    collider.body = id(), collider.surface = id();
    told(asp_pairs_add(pairs, &collider, &index));
    asp_placed placed[2] = {{{0, 0, number()}, {1, 0, 0, 0, 1, 0, 0, 0, 1}, {number(), 0, 0}, {0, 0, 0}},
                            {{0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, number()}, {0, 0, number()}, {0, number(), 0}}};
    asp_touch touch = {{rnd(3), rnd(3)}, {number(), 0, 0}, {0, 0, rnd(2) ? 1 : number()}, rnd(2) ? 1 : number(), rnd(2) ? 0 : number()};
    for (int step = 0; step < 3; step++)
        told(asp_pairs_step(pairs, heard, step + number(), rnd(3) ? 0.002 : number(), placed, &touch, rnd(2), rnd(3) ? &events : NULL));
    told(asp_pairs_free(pairs));
}

static void rest(void) {
    uint32_t n;
    uint64_t to;
    char words[200];
    float peaks[64];
    double number_;
    asp_stats stats;
    asp_stats_init(&stats);
    switch (rnd(24)) {
    case 0: told(asp_remove_body(scene(), id())); break;
    case 1: told(asp_remove_surface(scene(), id())); break;
    case 2: told(asp_set_body_bus(scene(), id(), rnd(4))); break;
    case 3: told(asp_set_body_gain(scene(), id(), number())); break;
    case 4: told(asp_add_probe(scene(), text(), text(), &ids[rnd(2 * POOL)])); break;
    case 5: told(asp_find(scene(), rnd(5), text(), &to)); break;
    case 6: told(asp_set_haptic_gain(scene(), rnd(4), number())); break;
    case 7: told(asp_set_bus_gain(scene(), rnd(4), number())); break;
    case 8: told(asp_set_muted(scene(), rnd(2))); break;
    case 9: told(asp_set_paused(scene(), rnd(2))); break;
    case 10: told(asp_fade_all(scene())); break;
    case 11: told(asp_reset(scene())); break;
    case 12: told(asp_set_time_scale(scene(), number())), told(asp_bend_time(scene(), number())); break;
    case 13: stats.struct_size = size_of(sizeof stats); told(asp_get_stats(scene(), &stats)); break;
    case 14: told((rnd(2) ? asp_why_silent : asp_why_clipped)(scene(), words, rnd(201))); break;
    case 15: told(asp_bus_peaks(scene(), peaks, rnd(70) % 65)); break;
    case 16: told(asp_record_start(scene())); break;
    case 17: told(asp_record_stop(scene(), rnd(2) ? NULL : "/nowhere/at/all")); break;
    case 18: told(asp_collect(scene(), &n)); break;
    case 19: told(asp_set_sample_rate(scene(), renderer(), rnd(2) ? 48000 : number() * 1e5)); break;
    case 20: told(asp_signals(renderer(), &n, &n, NULL, rnd(2) ? &n : NULL)), told(asp_unity_slot(renderer(), &n)); break;
    case 21: told(asp_get_level(scene(), rnd(5), rnd(2) ? rnd(4) : id(), rnd(9) ? &number_ : NULL)); break;
    case 22: pickups(); break;
    default: {
        asp_event events[4];
        double times_s[4];
        told(asp_read_log(scene(), text(), events, times_s, rnd(5), size_of(sizeof *events), &n));
    }
    }
}

static void any_call(void) {
    uint32_t what = rnd(100);
    if (what < 4)
        make();
    else if (what < 20)
        body_or_surface();
    else if (what < 45)
        report();
    else if (what < 70)
        render();
    else if (what < 80)
        ports_and_players();
    else
        rest();
}

static void free_all(void) {
    for (int i = 0; i < POOL; i++) {
        asp_player_stop(players[i], NULL), asp_port_free(ports[i]), asp_renderer_free(renderers[i]), asp_scene_free(scenes[i]);
        players[i] = NULL, ports[i] = NULL, renderers[i] = NULL, scenes[i] = NULL;
    }
}

#ifdef BYTES_OF_A_FUZZER
void asperity_calls(const uint8_t *data, size_t size);
void asperity_calls(const uint8_t *data, size_t size) {
    dice = data, dice_left = size, state = 1;
    make();
    while (dice_left > 2)
        any_call();
    free_all();
    memset(ids, 0, sizeof ids);
}
#else
int main(int count, char **words) {
    MUST(count == 3);
    long first = atol(words[1]), sequences = atol(words[2]);
    for (long s = first; s < first + sequences; s++) {
        state = 0x9e3779b97f4a7c15u ^ (uint64_t)s * 0xd1342543de82ef95u;
        make();
        for (int i = 0; i < 150; i++)
            any_call();
    }
    free_all();
    printf("fuzz: %ld calls, %ld refused with a sentence, none crashed\n", calls, refusals);
    return 0;
}
#endif
