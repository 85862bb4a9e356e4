/* What no program should do: null, sizes and counts that cannot be, stale ids, frees in any order, other threads. Each is answered with a
 * status and a sentence, and what renders is silent. */
#define _POSIX_C_SOURCE 200809L
#include "common.h"

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <time.h>

/* A call is refused with a status, and with a sentence that holds a word. */
#define REFUSED(call, with, word)                                                                                      \
    do {                                                                                                               \
        int32_t status_ = (call);                                                                                      \
        const char *text_ = asp_last_error();                                                                          \
        if (status_ != (with) || !strstr(text_, (word))) {                                                             \
            fprintf(stderr, "%s:%d: %s gave %d, \"%s\"; must be %d and speak of \"%s\"\n", __FILE__, __LINE__, #call,  \
                    (int)status_, text_, (int)(with), (word));                                                         \
            exit(1);                                                                                                   \
        }                                                                                                              \
        refusals_++;                                                                                                   \
    } while (0)
/* The same on any thread: nothing is counted. */
#define REFUSED_BY_STATUS(call, with, word) MUST((call) == (with) && strstr(asp_last_error(), (word)))
static int refusals_;
/* Fewer threads and rounds: under valgrind one thread runs at a time. */
static int few;

static asp_config exact(void) {
    asp_config config;
    asp_config_init(&config);
    config.clock = ASP_CLOCK_EXACT;
    return config;
}

static void build(asp_scene **scene, asp_renderer **renderer) {
    asp_config config = exact();
    MUST(asp_build(&config, scene, renderer) == ASP_OK);
}

static uint64_t bell(asp_scene *scene) {
    asp_body body;
    asp_body_init(&body);
    body.stock = "bar", body.size_m = 0.2;
    uint64_t id = 0;
    MUST(asp_add_body(scene, &body, &id) == ASP_OK && id != 0);
    return id;
}

static uint64_t plane(asp_scene *scene, uint64_t body) {
    asp_surface surface;
    asp_surface_init(&surface);
    surface.width_m = surface.height_m = 0.1, surface.body = body;
    uint64_t id = 0;
    MUST(asp_add_surface(scene, &surface, &id) == ASP_OK && id != 0);
    return id;
}

/* Every pointer of every call, null. */
static void nulls(void) {
    asp_scene *scene;
    asp_renderer *renderer;
    build(&scene, &renderer);
    asp_config config = exact();
    asp_body body;
    asp_surface surface;
    asp_event event;
    asp_stats stats;
    asp_port_config port;
    asp_body_init(&body), asp_surface_init(&surface), asp_event_init(&event), asp_stats_init(&stats);
    asp_port_config_init(&port);
    asp_config_init(NULL), asp_files_init(NULL), asp_body_init(NULL), asp_surface_init(NULL), asp_event_init(NULL);
    asp_init_event(NULL, sizeof event), asp_init_stats(NULL, 0), asp_init_body(NULL, UINT32_MAX);
    asp_stats_init(NULL), asp_port_config_init(NULL), asp_player_config_init(NULL), asp_player_report_init(NULL);
    uint64_t id;
    uint32_t number;
    REFUSED(asp_check_abi(ASP_ABI, NULL, 3), ASP_BAD_ARGUMENT, "null");
    REFUSED(asp_build(NULL, &scene, &renderer), ASP_BAD_ARGUMENT, "config");
    REFUSED(asp_build(&config, NULL, &renderer), ASP_BAD_ARGUMENT, "scene");
    REFUSED(asp_load(NULL, NULL, NULL, NULL, &scene, &renderer), ASP_BAD_ARGUMENT, "path");
    build(&scene, &renderer);
    REFUSED(asp_find(scene, ASP_BODY, NULL, &id), ASP_BAD_ARGUMENT, "name");
    REFUSED(asp_find(scene, ASP_BODY, "x", NULL), ASP_BAD_ARGUMENT, "id");
    REFUSED(asp_find(NULL, ASP_BODY, "x", &id), ASP_BAD_HANDLE, "scene");
    REFUSED(asp_add_body(scene, NULL, &id), ASP_BAD_ARGUMENT, "body");
    REFUSED(asp_add_body(scene, &body, NULL), ASP_BAD_ARGUMENT, "id");
    REFUSED(asp_add_body(NULL, &body, &id), ASP_BAD_HANDLE, "scene");
    REFUSED(asp_replace_body(scene, 1, NULL), ASP_BAD_ARGUMENT, "body");
    REFUSED(asp_replace_body(NULL, 1, &body), ASP_BAD_HANDLE, "scene");
    REFUSED(asp_remove_body(NULL, 1), ASP_BAD_HANDLE, "scene");
    REFUSED(asp_set_body_bus(NULL, 1, 0), ASP_BAD_HANDLE, "scene");
    REFUSED(asp_set_body_gain(NULL, 1, 1), ASP_BAD_HANDLE, "scene");
    REFUSED(asp_set_body_send(NULL, 1, 1, 1), ASP_BAD_HANDLE, "scene");
    REFUSED(asp_add_surface(scene, NULL, &id), ASP_BAD_ARGUMENT, "surface");
    REFUSED(asp_add_surface(scene, &surface, NULL), ASP_BAD_ARGUMENT, "id");
    REFUSED(asp_add_surface(NULL, &surface, &id), ASP_BAD_HANDLE, "scene");
    REFUSED(asp_replace_surface(NULL, 1, &surface), ASP_BAD_HANDLE, "scene");
    REFUSED(asp_remove_surface(NULL, 1), ASP_BAD_HANDLE, "scene");
    REFUSED(asp_add_probe(scene, NULL, NULL, &id), ASP_BAD_ARGUMENT, "table");
    REFUSED(asp_add_probe(NULL, "", NULL, &id), ASP_BAD_HANDLE, "scene");
    REFUSED(asp_report(scene, 0, NULL, 1, sizeof event, NULL), ASP_BAD_ARGUMENT, "events");
    REFUSED(asp_report(NULL, 0, &event, 1, sizeof event, NULL), ASP_BAD_HANDLE, "scene");
    REFUSED(asp_read_log(scene, NULL, &event, NULL, 1, sizeof event, &number), ASP_BAD_ARGUMENT, "text");
    REFUSED(asp_read_log(scene, "{\"t\":0,\"event\":\"end\",\"contact\":1}", &event, NULL, 1, sizeof event, &number),
            ASP_BAD_ARGUMENT, "times_s");
    REFUSED(asp_material(NULL, &number), ASP_BAD_ARGUMENT, "name");
    REFUSED(asp_material("wood", NULL), ASP_BAD_ARGUMENT, "number");
    REFUSED(asp_get_stats(scene, NULL), ASP_BAD_ARGUMENT, "stats");
    REFUSED(asp_get_stats(NULL, &stats), ASP_BAD_HANDLE, "scene");
    REFUSED(asp_bus_peaks(scene, NULL, 1), ASP_BAD_ARGUMENT, "peaks");
    REFUSED(asp_why_silent(scene, NULL, 10), ASP_BAD_ARGUMENT, "reasons");
    REFUSED(asp_why_clipped(scene, NULL, 10), ASP_BAD_ARGUMENT, "reasons");
    REFUSED(asp_collect(NULL, NULL), ASP_BAD_HANDLE, "scene");
    REFUSED(asp_record_start(NULL), ASP_BAD_HANDLE, "scene");
    REFUSED(asp_record_stop(NULL, NULL), ASP_BAD_HANDLE, "scene");
    REFUSED(asp_open_port(scene, NULL, NULL), ASP_BAD_ARGUMENT, "config");
    REFUSED(asp_open_port(scene, &port, NULL), ASP_BAD_ARGUMENT, "port");
    asp_tip *tip;
    double at_m[3] = {0, 0, 0};
    REFUSED(asp_tip_new(NULL, NULL, 0, NAN, NAN, NAN, &tip), ASP_BAD_HANDLE, "scene");
    REFUSED(asp_tip_new(scene, NULL, 0, NAN, NAN, NAN, NULL), ASP_BAD_ARGUMENT, "tip");
    REFUSED(asp_tip_new(scene, NULL, 1, NAN, NAN, NAN, &tip), ASP_BAD_ARGUMENT, "surfaces");
    REFUSED(asp_tip_new(scene, NULL, 0, 0.0, NAN, NAN, &tip), ASP_REFUSED, "stiffness_n_m");
    REFUSED(asp_tip_step(NULL, 0.01, at_m, 1, 0, &event), ASP_BAD_HANDLE, "tip");
    REFUSED(asp_tip_step(NULL, 0.01, NULL, 1, 0, &event), ASP_BAD_ARGUMENT, "position_m");
    REFUSED(asp_tip_lift(NULL, 1, &event), ASP_BAD_HANDLE, "tip");
    REFUSED(asp_signals(NULL, NULL, NULL, NULL, NULL), ASP_BAD_HANDLE, "renderer");
    REFUSED(asp_set_sample_rate(scene, NULL, 48000), ASP_BAD_HANDLE, "renderer");
    REFUSED(asp_set_sample_rate(NULL, renderer, 48000), ASP_BAD_HANDLE, "scene");
    REFUSED(asp_unity_slot(renderer, NULL), ASP_BAD_ARGUMENT, "slot");
    REFUSED(asp_unity_slot(NULL, &number), ASP_BAD_HANDLE, "renderer");
    REFUSED(asp_play(renderer, NULL, NULL), ASP_BAD_ARGUMENT, "player");
    REFUSED(asp_get_player_report(NULL, NULL), ASP_BAD_HANDLE, "player");
    REFUSED(asp_player_device(NULL, NULL, 1), ASP_BAD_ARGUMENT, "words");
    REFUSED(asp_sink_bytes(NULL, NULL, 0), ASP_BAD_ARGUMENT, "sink");
    REFUSED(asp_sink_picture(NULL, NULL), ASP_BAD_ARGUMENT, "sink");
    REFUSED(asp_reset(NULL), ASP_BAD_HANDLE, "scene");
    REFUSED(asp_set_time_scale(NULL, 1), ASP_BAD_HANDLE, "scene");
    REFUSED(asp_bend_time(NULL, 1), ASP_BAD_HANDLE, "scene");
    REFUSED(asp_report_named(scene, 0, 1, NULL, sizeof event), ASP_BAD_ARGUMENT, "event");
    REFUSED(asp_withdraw(scene, 1, NULL), ASP_BAD_ARGUMENT, "waited");
    REFUSED(asp_withdraw(NULL, 1, &number), ASP_BAD_HANDLE, "scene");
    REFUSED(asp_play_clip(NULL, 0, 0, NULL, 0, 8000, 1, 1), ASP_BAD_HANDLE, "scene");
    REFUSED(asp_play_clip(scene, 0, 0, NULL, 5, 8000, 1, 1), ASP_BAD_ARGUMENT, "samples");
    REFUSED(asp_set_haptic_gain(NULL, 0, 1), ASP_BAD_HANDLE, "scene");
    REFUSED(asp_set_bus_gain(NULL, 0, 1), ASP_BAD_HANDLE, "scene");
    double level;
    REFUSED(asp_get_level(NULL, ASP_LEVEL_BUS_GAIN, 0, &level), ASP_BAD_HANDLE, "scene");
    REFUSED(asp_get_level(scene, ASP_LEVEL_BUS_GAIN, 0, NULL), ASP_BAD_ARGUMENT, "level");
    REFUSED(asp_set_muted(NULL, 1), ASP_BAD_HANDLE, "scene");
    REFUSED(asp_set_paused(NULL, 1), ASP_BAD_HANDLE, "scene");
    REFUSED(asp_fade_all(NULL), ASP_BAD_HANDLE, "scene");
    asp_render(NULL, NULL, 0, NULL, 0, 64), asp_render(renderer, NULL, 1, NULL, 1, 64);
    asp_render_interleaved(renderer, NULL, 2, 64, NULL), asp_render_interleaved(NULL, NULL, 2, 64, NULL);
    asp_report_load(NULL, 0.5f), asp_port_levels(NULL, NULL, NULL);
    MUST(asp_port_pcm(NULL, NULL, 5) == 0 && asp_port_points(NULL, NULL, 5) == 0 && asp_port_forces(NULL, NULL, 5) == 0);
    MUST(asp_port_lost(NULL) == 0 && asp_player_stop(NULL, NULL) == ASP_OK && asp_port_free(NULL) == ASP_OK);
    MUST(asp_scene_free(NULL) == ASP_OK && asp_renderer_free(NULL) == ASP_OK);
    MUST(asp_report(scene, 0, NULL, 0, sizeof event, NULL) == ASP_OK && asp_last_error()[0] == 0);
    MUST(asp_renderer_free(renderer) == ASP_OK && asp_scene_free(scene) == ASP_OK);
}

/* Sizes of 0, of 2^32 - 1 and of a younger header; counts without end. */
static void sizes(void) {
    asp_scene *scene;
    asp_renderer *renderer;
    build(&scene, &renderer);
    const uint32_t wrong[] = {0, 1, 4, (uint32_t)sizeof(asp_event) - 1, (uint32_t)sizeof(asp_event) + 8, UINT32_MAX};
    for (int i = 0; i < 6; i++) {
        asp_config config = exact();
        asp_body body;
        asp_surface surface;
        asp_event event = asp_end(1);
        asp_stats stats;
        asp_port_config port;
        asp_player_config player;
        asp_files files;
        asp_scene *s;
        asp_renderer *r;
        asp_port *p;
        asp_player *q;
        uint64_t id;
        asp_body_init(&body), asp_surface_init(&surface), asp_port_config_init(&port), asp_player_config_init(&player);
        asp_files_init(&files);
        config.struct_size = body.struct_size = surface.struct_size = port.struct_size = player.struct_size = wrong[i];
        stats.struct_size = files.struct_size = wrong[i];
        REFUSED(asp_build(&config, &s, &r), ASP_BAD_ARGUMENT, "struct_size");
        REFUSED(asp_add_body(scene, &body, &id), ASP_BAD_ARGUMENT, "asp_body_init");
        REFUSED(asp_add_surface(scene, &surface, &id), ASP_BAD_ARGUMENT, "struct_size");
        REFUSED(asp_open_port(scene, &port, &p), ASP_BAD_ARGUMENT, "struct_size");
        REFUSED(asp_play(renderer, &player, &q), ASP_BAD_ARGUMENT, "struct_size");
        REFUSED(asp_get_stats(scene, &stats), ASP_BAD_ARGUMENT, "struct_size");
        REFUSED(asp_load("x.toml", NULL, &files, NULL, &s, &r), ASP_BAD_ARGUMENT, "struct_size");
        REFUSED(asp_report(scene, 0, &event, 1, wrong[i], NULL), ASP_BAD_ARGUMENT, "sizeof(asp_event)");
        event.struct_size = wrong[i];
        REFUSED(asp_report(scene, 0, &event, 1, sizeof event, NULL), ASP_BAD_ARGUMENT, "struct_size");
        /* Nothing is written into what never was. */
        asp_event untouched;
        memset(&untouched, 0x55, sizeof untouched);
        asp_init_event(&untouched, wrong[i]);
        MUST(untouched.struct_size == 0x55555555 && untouched.contact == 0x5555555555555555);
        uint32_t bad[1] = {wrong[i]};
        REFUSED(asp_check_abi(ASP_ABI, bad, 1), ASP_ABI_MISMATCH, "asp_config");
    }
    REFUSED(asp_check_abi(ASP_ABI + 1, NULL, 0), ASP_ABI_MISMATCH, "interface");
    asp_event event = asp_end(1);
    uint32_t taken = 7;
    REFUSED(asp_report(scene, 0, &event, UINT32_MAX, sizeof event, &taken), ASP_BAD_ARGUMENT, "count");
    MUST(taken == 0);
    float sample = 3.0f, *planes[1] = {&sample};
    asp_render(renderer, planes, UINT32_MAX, planes, UINT32_MAX, 1), asp_render(renderer, planes, 1, NULL, 0, UINT32_MAX);
    asp_render_interleaved(renderer, &sample, UINT32_MAX, UINT32_MAX, NULL);
    asp_render_interleaved(renderer, &sample, 1, UINT32_MAX, NULL), asp_render_interleaved(renderer, &sample, 0, 9, NULL);
    MUST(sample == 3.0f);
    char text[1] = {5};
    REFUSED(asp_why_silent(scene, text, 0), ASP_BAD_ARGUMENT, "size");
    MUST(asp_why_silent(scene, text, 1) == ASP_OK && text[0] == 0);
    REFUSED(asp_why_clipped(scene, text, 0), ASP_BAD_ARGUMENT, "size");
    MUST(asp_why_clipped(scene, text, 1) == ASP_OK && text[0] == 0);
    REFUSED(asp_bus_peaks(scene, &sample, UINT32_MAX), ASP_BAD_ARGUMENT, "64");
    asp_body body;
    asp_body_init(&body);
    asp_mode mode = {500.0, 3.0, 1.0, 0.0};
    uint64_t id;
    body.modes = &mode, body.mode_count = UINT32_MAX;
    REFUSED(asp_add_body(scene, &body, &id), ASP_BAD_ARGUMENT, "65536");
    body.mode_count = 1, body.bus = UINT32_MAX;
    REFUSED(asp_add_body(scene, &body, &id), ASP_UNKNOWN, "bus");
    asp_surface surface;
    asp_surface_init(&surface);
    unsigned char grey[4] = {0, 255, 255, 0};
    surface.width_m = surface.height_m = 0.1, surface.relief_m = 1e-4, surface.heights.samples = grey;
    surface.heights.width = surface.heights.height = UINT32_MAX;
    REFUSED(asp_add_surface(scene, &surface, &id), ASP_BAD_ARGUMENT, "heights");
    surface.heights.width = surface.heights.height = 32768;
    REFUSED(asp_add_surface(scene, &surface, &id), ASP_BAD_ARGUMENT, "2^26");
    surface.heights.width = surface.heights.height = 2, surface.heights.channels = 9;
    REFUSED(asp_add_surface(scene, &surface, &id), ASP_BAD_ARGUMENT, "channels");
    surface.heights.channels = 1, surface.heights.stride_bytes = UINT64_MAX;
    REFUSED(asp_add_surface(scene, &surface, &id), ASP_BAD_ARGUMENT, "stride_bytes");
    surface.heights.stride_bytes = 0, surface.heights.format = 77;
    REFUSED(asp_add_surface(scene, &surface, &id), ASP_BAD_ARGUMENT, "format");
    surface.heights.format = ASP_U8, surface.wrap = 9;
    REFUSED(asp_add_surface(scene, &surface, &id), ASP_BAD_ARGUMENT, "wrap");
    surface.wrap = 0;
    MUST(asp_add_surface(scene, &surface, &id) == ASP_OK);
    MUST(asp_scene_free(scene) == ASP_OK && asp_renderer_free(renderer) == ASP_OK);
}

/* Ids of what is gone, ids that never were, numbers that nothing has; each sentence names its field. */
static void ids_and_numbers(void) {
    asp_scene *scene;
    asp_renderer *renderer;
    build(&scene, &renderer);
    uint64_t body = bell(scene), surface = plane(scene, body), id;
    MUST(asp_remove_surface(scene, surface) == ASP_OK && asp_remove_body(scene, body) == ASP_OK);
    uint64_t body2 = bell(scene), surface2 = plane(scene, body2);
    MUST(body2 != body && surface2 != surface);
    const uint64_t gone[] = {0, body, 1, UINT64_MAX, UINT32_MAX};
    for (int i = 0; i < 5; i++) {
        asp_event event = asp_begin(1, gone[i] == body ? surface : gone[i], 0, 0.5, 0.5, 0.5);
        REFUSED(asp_report(scene, 0, &event, 1, sizeof event, NULL), ASP_UNKNOWN, "surface");
        event = asp_impact(gone[i], 1, 0.01, 0.005);
        REFUSED(asp_report(scene, 0, &event, 1, sizeof event, NULL), ASP_UNKNOWN, "body");
        REFUSED(asp_remove_body(scene, gone[i]), ASP_UNKNOWN, "body");
        REFUSED(asp_set_body_gain(scene, gone[i], 1), ASP_UNKNOWN, "body");
        REFUSED(asp_remove_surface(scene, gone[i] == body ? surface : gone[i]), ASP_UNKNOWN, "surface");
    }
    asp_event event = asp_begin(1, surface2, 5, 0.5, 0.5, 0.5);
    REFUSED(asp_report(scene, 0, &event, 1, sizeof event, NULL), ASP_UNKNOWN, "actuator");
    event.actuator = -2;
    REFUSED(asp_report(scene, 0, &event, 1, sizeof event, NULL), ASP_BAD_ARGUMENT, "actuator");
    event.actuator = 0, event.probe = 12345;
    REFUSED(asp_report(scene, 0, &event, 1, sizeof event, NULL), ASP_UNKNOWN, "probe");
    event.probe = 0, event.normal_force_n = INFINITY;
    REFUSED(asp_report(scene, 0, &event, 1, sizeof event, NULL), ASP_REFUSED, "normal_force_n");
    event.normal_force_n = 1, event.uv[0] = NAN;
    REFUSED(asp_report(scene, 0, &event, 1, sizeof event, NULL), ASP_REFUSED, "uv");
    event.uv[0] = 0, event.kind = 9;
    REFUSED(asp_report(scene, 0, &event, 1, sizeof event, NULL), ASP_BAD_ARGUMENT, "kind");
    event.kind = ASP_BEGIN, event.slip_m_s = -1;
    REFUSED(asp_report(scene, 0, &event, 1, sizeof event, NULL), ASP_REFUSED, "slip_m_s");
    event = asp_rolling(event, -1, 0);
    REFUSED(asp_report(scene, 0, &event, 1, sizeof event, NULL), ASP_REFUSED, "roll_radius_m");
    event.slip_m_s = event.roll_radius_m = NAN, event.depth_m = 0.001;
    REFUSED(asp_report(scene, 0, &event, 1, sizeof event, NULL), ASP_REFUSED, "depth_m");
    event = asp_impact(body2, 1, 0.01, 0.005), event.striker = 99;
    REFUSED(asp_report(scene, 0, &event, 1, sizeof event, NULL), ASP_REFUSED, "material");
    event.striker = ASP_MATERIAL_CUSTOM;
    REFUSED(asp_report(scene, 0, &event, 1, sizeof event, NULL), ASP_REFUSED, "young_pa");
    REFUSED(asp_report(scene, NAN, NULL, 0, 0, NULL), ASP_BAD_ARGUMENT, "size");
    event.striker = ASP_MATERIAL_WOOD;
    REFUSED(asp_report(scene, NAN, &event, 1, sizeof event, NULL), ASP_REFUSED, "time_s");
    asp_config config = exact();
    asp_scene *s;
    asp_renderer *r;
    config.sample_rate_hz = 100;
    REFUSED(asp_build(&config, &s, &r), ASP_REFUSED, "8000 to 384000");
    config.sample_rate_hz = 0, config.haptic_channels = 65;
    REFUSED(asp_build(&config, &s, &r), ASP_REFUSED, "haptic_channels");
    config.haptic_channels = 0, config.more = "sampel = 1";
    REFUSED(asp_build(&config, &s, &r), ASP_REFUSED, "sampel");
    config.more = "actuators = [", config.kernel = 0;
    REFUSED(asp_build(&config, &s, &r), ASP_REFUSED, "config");
    config.more = "\xff\xfe";
    REFUSED(asp_build(&config, &s, &r), ASP_BAD_ARGUMENT, "UTF-8");
    config.more = NULL, config.clock = 7;
    REFUSED(asp_build(&config, &s, &r), ASP_REFUSED, "clock");
    config.clock = 0, config.kernel = 7;
    REFUSED(asp_build(&config, &s, &r), ASP_REFUSED, "kernel");
    REFUSED(asp_load("nowhere.toml", NULL, NULL, NULL, &s, &r), ASP_FILE, "nowhere.toml: no such file");
    REFUSED(asp_load("here.toml", "[[body]]\n", NULL, NULL, &s, &r), ASP_FILE, "name");
    REFUSED(asp_find(scene, ASP_BODY, "gong", &id), ASP_UNKNOWN, "gong");
    REFUSED(asp_find(scene, 44, "gong", &id), ASP_BAD_ARGUMENT, "kind");
    REFUSED(asp_set_haptic_gain(scene, 70000, 1), ASP_UNKNOWN, "channel");
    REFUSED(asp_set_haptic_gain(scene, 0, NAN), ASP_REFUSED, "gain");
    REFUSED(asp_set_bus_gain(scene, 5, 1), ASP_UNKNOWN, "bus");
    double level;
    REFUSED(asp_get_level(scene, 0, 0, &level), ASP_BAD_ARGUMENT, "ASP_LEVEL_FULL_SCALE");
    REFUSED(asp_get_level(scene, ASP_LEVEL_FULL_SCALE, 9, &level), ASP_UNKNOWN, "haptic channel");
    REFUSED(asp_get_level(scene, ASP_LEVEL_BUS_GAIN, UINT64_MAX, &level), ASP_UNKNOWN, "audio bus");
    REFUSED(asp_get_level(scene, ASP_LEVEL_STRIKE_GAIN, body, &level), ASP_UNKNOWN, "body");
    asp_body loud;
    asp_body_init(&loud);
    loud.stock = "bar", loud.size_m = 0.2, loud.strike_gain = 1e9;
    REFUSED(asp_add_body(scene, &loud, &id), ASP_REFUSED, "strike_gain");
    REFUSED(asp_set_time_scale(scene, -1), ASP_REFUSED, "time_scale");
    REFUSED(asp_bend_time(scene, 3), ASP_REFUSED, "time_scale");
    float hum[4] = {0.1f, 0.2f, NAN, 0.0f};
    REFUSED(asp_play_clip(scene, 1, 0, hum, 4, 8000, 1, 1), ASP_REFUSED, "samples");
    REFUSED(asp_play_clip(scene, 1, 0, hum, 2, 8000, 1, 3), ASP_REFUSED, "ducking");
    REFUSED(asp_play_clip(scene, 1, 70000, hum, 2, 8000, 1, 1), ASP_UNKNOWN, "actuator");
    MUST(asp_play_clip(scene, 1, 0, hum, 2, 8000, 1, 1) == ASP_OK);
    asp_event blow;
    asp_init_event(&blow, sizeof blow);
    blow.kind = ASP_END;
    REFUSED(asp_report_named(scene, 0, 5, &blow, sizeof blow), ASP_BAD_ARGUMENT, "kind");
    uint64_t gong;
    loud.strike_gain = 1.0;
    MUST(asp_add_body(scene, &loud, &gong) == ASP_OK);
    blow.kind = ASP_IMPACT, blow.body = gong;
    uint32_t waited;
    MUST(asp_report_named(scene, 1, 5, &blow, sizeof blow) == ASP_OK);
    MUST(asp_report_named(scene, 1, 5, &blow, sizeof blow) == ASP_OK);
    MUST(asp_withdraw(scene, 5, &waited) == ASP_OK && waited == 1);
    MUST(asp_withdraw(scene, 5, &waited) == ASP_OK && waited == 0);
    REFUSED(asp_set_sample_rate(scene, renderer, NAN), ASP_REFUSED, "sample_rate_hz");
    asp_body wrong;
    asp_body_init(&wrong);
    wrong.stock = "cube", wrong.size_m = 1;
    REFUSED(asp_add_body(scene, &wrong, &id), ASP_REFUSED, "cube");
    wrong.stock = NULL, wrong.table = "bus = \"left\"";
    REFUSED(asp_add_body(scene, &wrong, &id), ASP_REFUSED, "bus");
    wrong.table = NULL, wrong.gain = NAN;
    REFUSED(asp_add_body(scene, &wrong, &id), ASP_REFUSED, "gain");
    wrong.gain = 1, wrong.modes_json = "{";
    REFUSED(asp_add_body(scene, &wrong, &id), ASP_REFUSED, "modes");
    asp_surface flat;
    asp_surface_init(&flat);
    REFUSED(asp_add_surface(scene, &flat, &id), ASP_REFUSED, "width_m");
    flat.width_m = flat.height_m = 0.1, flat.body = body;
    REFUSED(asp_add_surface(scene, &flat, &id), ASP_UNKNOWN, "body");
    asp_port_config wanted;
    asp_port *port;
    asp_port_config_init(&wanted);
    wanted.index = 3;
    REFUSED(asp_open_port(scene, &wanted, &port), ASP_UNKNOWN, "actuator");
    wanted.index = 0, wanted.holds_s = 1e9;
    REFUSED(asp_open_port(scene, &wanted, &port), ASP_REFUSED, "holds_s");
    wanted.kind = 9;
    REFUSED(asp_open_port(scene, &wanted, &port), ASP_BAD_ARGUMENT, "kind");
    MUST(asp_renderer_free(renderer) == ASP_OK && asp_scene_free(scene) == ASP_OK);
}

/* Handles of another kind, freed twice, freed in any order. */
static void handles(void) {
    for (int order = 0; order < 6; order++) {
        asp_scene *scene;
        asp_renderer *renderer;
        asp_port *port;
        build(&scene, &renderer);
        asp_port_config wanted;
        asp_port_config_init(&wanted);
        MUST(asp_open_port(scene, &wanted, &port) == ASP_OK);
        float out[128];
        asp_render_interleaved(renderer, out, 2, 64, NULL);
        static const char orders[6][4] = {"srp", "spr", "rsp", "rps", "psr", "prs"};
        for (int i = 0; i < 3; i++) {
            switch (orders[order][i]) {
            case 's':
                MUST(asp_scene_free(scene) == ASP_OK);
                REFUSED(asp_scene_free(scene), ASP_BAD_HANDLE, "freed");
                REFUSED(asp_reset(scene), ASP_BAD_HANDLE, "freed");
                break;
            case 'r':
                MUST(asp_renderer_free(renderer) == ASP_OK);
                REFUSED(asp_renderer_free(renderer), ASP_BAD_HANDLE, "freed");
                out[0] = 1, asp_render_interleaved(renderer, out, 2, 64, NULL);
                MUST(out[0] == 0);
                break;
            default:
                MUST(asp_port_free(port) == ASP_OK);
                REFUSED(asp_port_free(port), ASP_BAD_HANDLE, "freed");
                MUST(asp_port_pcm(port, out, 128) == 0);
            }
            asp_render_interleaved(renderer, out, 2, 64, NULL);
            asp_collect(scene, NULL);
        }
    }
    asp_scene *scene;
    asp_renderer *renderer;
    build(&scene, &renderer);
    long wild = 0;
    REFUSED(asp_scene_free((asp_scene *)renderer), ASP_BAD_HANDLE, "scene");
    REFUSED(asp_renderer_free((asp_renderer *)scene), ASP_BAD_HANDLE, "renderer");
    REFUSED(asp_reset((asp_scene *)&wild), ASP_BAD_HANDLE, "scene");
    asp_player_config player;
    asp_player_config_init(&player);
    asp_player *playing, *again;
    player.silent = 1, player.block_frames = 70000;
    REFUSED(asp_play(renderer, &player, &playing), ASP_BAD_ARGUMENT, "block_frames");
    player.block_frames = 64, player.channels = "video=1";
    REFUSED(asp_play(renderer, &player, &playing), ASP_REFUSED, "channels");
    player.channels = NULL;
    MUST(asp_play(renderer, &player, &playing) == ASP_OK);
    REFUSED(asp_play(renderer, &player, &again), ASP_BAD_HANDLE, "renderer");
    REFUSED(asp_renderer_free(renderer), ASP_BAD_HANDLE, "renderer");
    struct timespec wait = {0, 60000000};
    nanosleep(&wait, NULL);
    MUST(asp_scene_free(scene) == ASP_OK);
    asp_player_report report;
    asp_player_report_init(&report);
    MUST(asp_player_stop(playing, &report) == ASP_OK && report.callbacks > 0 && report.silent == 1);
    REFUSED(asp_player_stop(playing, &report), ASP_BAD_HANDLE, "player");
}

static asp_scene *shared_scene;
static asp_renderer *shared_renderer;
static asp_port *shared_port;
static asp_player *shared_player;
static atomic_int odd, busy;

static void *everything(void *seed) {
    uint32_t random = (uint32_t)(size_t)seed;
    float out[2 * 64];
    for (int i = 0; i < 400; i++) {
        random = random * 1664525u + 1013904223u;
        int32_t status = ASP_OK;
        uint64_t id;
        asp_body body;
        asp_body_init(&body);
        switch (random >> 28) {
        case 0:
            status = asp_add_body(shared_scene, &body, &id);
            break;
        case 1:
            status = asp_reset(shared_scene);
            break;
        case 2:
            status = asp_collect(shared_scene, NULL);
            break;
        case 3:
        case 4:
            asp_port_pcm(shared_port, out, 2 * 64), asp_port_lost(shared_port);
            break;
        case 5: {
            asp_player_report report;
            char words[40];
            asp_player_report_init(&report);
            status = random & 1 ? asp_get_player_report(shared_player, &report) : asp_player_device(shared_player, words, 40);
            break;
        }
        default:
            asp_render_interleaved(shared_renderer, out, 2, 64, NULL);
        }
        if (status == ASP_BUSY) {
            MUST(strstr(asp_last_error(), "one thread at a time"));
            atomic_fetch_add(&busy, 1);
        } else if (status != ASP_OK && status != ASP_FULL && status != ASP_BAD_HANDLE) {
            atomic_fetch_add(&odd, 1);
        }
    }
    return NULL;
}

/* Many threads with the same handles, which are freed under them. */
static void threads(void) {
    for (int round = 0; round < (few ? 2 : 10); round++) {
        build(&shared_scene, &shared_renderer);
        asp_scene *played;
        asp_renderer *plays;
        asp_port_config wanted;
        asp_player_config silent;
        asp_port_config_init(&wanted), asp_player_config_init(&silent);
        silent.silent = 1, silent.block_frames = 64;
        build(&played, &plays);
        MUST(asp_open_port(shared_scene, &wanted, &shared_port) == ASP_OK && asp_play(plays, &silent, &shared_player) == ASP_OK);
        pthread_t all[6];
        for (size_t i = 0; i < 6; i++)
            MUST(pthread_create(&all[i], NULL, everything, (void *)(i + 1 + 6 * (size_t)round)) == 0);
        if (round % 2) {
            MUST(asp_scene_free(shared_scene) == ASP_OK && asp_port_free(shared_port) == ASP_OK);
            MUST(asp_renderer_free(shared_renderer) == ASP_OK && asp_player_stop(shared_player, NULL) == ASP_OK);
        }
        for (int i = 0; i < 6; i++)
            MUST(pthread_join(all[i], NULL) == 0);
        if (round % 2 == 0) {
            MUST(asp_renderer_free(shared_renderer) == ASP_OK && asp_scene_free(shared_scene) == ASP_OK);
            MUST(asp_port_free(shared_port) == ASP_OK && asp_player_stop(shared_player, NULL) == ASP_OK);
        }
        MUST(asp_scene_free(played) == ASP_OK);
    }
    MUST(atomic_load(&odd) == 0);
}

/* Called back while a file is asked for: with the scene that asks, with engines of its own, with the sink after its time. */
static asp_scene *asking;
static asp_renderer *asking_renderer;
static asp_sink *kept;
static int depth, asked;

static int32_t calls_back(void *user, const char *path, asp_sink *sink) {
    static const uint8_t modes[] = "{\"format\":\"asperity.modes\",\"version\":1,\"modes\":[{\"frequency_hz\":400,\"decay_per_s\":3,\"amplitude\":1}]}";
    MUST(user == (void *)&asking && strcmp(path, "m.json") == 0);
    asked++;
    asp_body body;
    uint64_t id;
    float out[128];
    asp_body_init(&body);
    REFUSED(asp_add_body(asking, &body, &id), ASP_BUSY, "one thread at a time");
    REFUSED(asp_reset(asking), ASP_BUSY, "one thread at a time");
    asp_render_interleaved(asking_renderer, out, 2, 64, NULL);
    if (kept)
        REFUSED(asp_sink_bytes(kept == sink ? (asp_sink *)&id : kept, modes, sizeof modes - 1), ASP_BAD_ARGUMENT, "not open");
    if (depth++ == 0) {
        /* Another engine's file, asked for from within; its sink is the open one meanwhile. */
        asp_scene *outer = asking;
        asp_renderer *outer_renderer = asking_renderer;
        asp_files files;
        asp_files_init(&files);
        files.read = calls_back, files.user = (void *)&asking;
        build(&asking, &asking_renderer);
        body.table = "modes = \"m.json\"", body.files = &files;
        kept = sink;
        MUST(asp_add_body(asking, &body, &id) == ASP_OK);
        kept = NULL;
        MUST(asp_scene_free(asking) == ASP_OK && asp_renderer_free(asking_renderer) == ASP_OK);
        asking = outer, asking_renderer = outer_renderer;
    }
    REFUSED(asp_sink_bytes(sink, NULL, 5), ASP_BAD_ARGUMENT, "bytes");
    REFUSED(asp_sink_bytes(sink, modes, (size_t)1 << 40), ASP_BAD_ARGUMENT, "bytes");
    MUST(asp_sink_bytes(sink, modes, 3) == ASP_OK);
    return asp_sink_bytes(sink, modes, sizeof modes - 1);
}

static void callbacks(void) {
    build(&asking, &asking_renderer);
    asp_files files;
    asp_files_init(&files);
    files.read = calls_back, files.user = (void *)&asking;
    asp_body body;
    asp_body_init(&body);
    body.table = "modes = \"m.json\"", body.files = &files;
    uint64_t id;
    MUST(asp_add_body(asking, &body, &id) == ASP_OK && asked == 2);
    MUST(asp_scene_free(asking) == ASP_OK && asp_renderer_free(asking_renderer) == ASP_OK);
}

/* Names and paths that are no UTF-8, or very long. */
static void texts(void) {
    asp_scene *scene, *s;
    asp_renderer *renderer, *r;
    build(&scene, &renderer);
    static const char *odd[] = {"\xff.toml", "a\xc3", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xc0\xaf"};
    asp_body body;
    asp_body_init(&body);
    uint64_t id;
    uint32_t number;
    asp_event event;
    for (int i = 0; i < 5; i++) {
        REFUSED(asp_load(odd[i], NULL, NULL, NULL, &s, &r), ASP_BAD_ARGUMENT, "UTF-8");
        REFUSED(asp_load("x", odd[i], NULL, NULL, &s, &r), ASP_BAD_ARGUMENT, "UTF-8");
        REFUSED(asp_find(scene, ASP_BODY, odd[i], &id), ASP_BAD_ARGUMENT, "UTF-8");
        body.name = odd[i];
        REFUSED(asp_add_body(scene, &body, &id), ASP_BAD_ARGUMENT, "UTF-8");
        REFUSED(asp_material(odd[i], &number), ASP_BAD_ARGUMENT, "UTF-8");
        REFUSED(asp_read_log(scene, odd[i], &event, NULL, 0, sizeof event, &number), ASP_BAD_ARGUMENT, "UTF-8");
        REFUSED(asp_add_probe(scene, odd[i], NULL, &id), ASP_BAD_ARGUMENT, "UTF-8");
        MUST(asp_record_start(scene) == ASP_OK);
        REFUSED(asp_record_stop(scene, odd[i]), ASP_BAD_ARGUMENT, "UTF-8");
        asp_record_stop(scene, NULL);
    }
    const size_t length = 1 << 20;
    char *giant = (char *)malloc(length + 1);
    MUST(giant);
    memset(giant, 'x', length), giant[length] = 0;
    MUST(asp_load(giant, NULL, NULL, NULL, &s, &r) == ASP_FILE && asp_load("x", giant, NULL, NULL, &s, &r) == ASP_FILE);
    REFUSED(asp_find(scene, ASP_BODY, giant, &id), ASP_UNKNOWN, "body");
    memset(giant, '[', length);
    body.name = NULL, body.table = giant;
    REFUSED(asp_add_body(scene, &body, &id), ASP_REFUSED, "table");
    MUST(asp_load("x", giant, NULL, NULL, &s, &r) == ASP_FILE);
    body.table = NULL, body.modes_json = giant;
    REFUSED(asp_add_body(scene, &body, &id), ASP_REFUSED, "modes");
    free(giant);
    MUST(asp_scene_free(scene) == ASP_OK && asp_renderer_free(renderer) == ASP_OK);
}

/* 64 threads that build, load, render and free engines of their own at once; and one engine more than there are handles. */
static void *own_engine(void *seed) {
    for (int i = 0; i < (few ? 1 : 6); i++) {
        asp_scene *scene;
        asp_renderer *renderer;
        static const char scene_file[] = "[[body]]\nname = \"a\"\nstock = \"disc\"\nsize_m = 0.1\n[[surface]]\nname = \"b\"\nbody = \"a\"\nwidth_m = 0.1\nheight_m = 0.1\n";
        asp_config config = exact();
        MUST(asp_load("a.toml", scene_file, NULL, &config, &scene, &renderer) == ASP_OK);
        uint64_t body, surface;
        MUST(asp_find(scene, ASP_BODY, "a", &body) == ASP_OK && asp_find(scene, ASP_SURFACE, "b", &surface) == ASP_OK);
        asp_event events[2] = {asp_impact(body, 1, 0.01, 0.005), asp_begin((size_t)seed, surface, 0, 0.5, 0.5, 1)};
        MUST(asp_report(scene, 0, events, 2, sizeof *events, NULL) == ASP_OK);
        float out[2 * 256], peak = 0;
        for (int block = 0; block < 4; block++) {
            asp_render_interleaved(renderer, out, 2, 256, NULL);
            for (int s = 0; s < 2 * 256; s++)
                peak = fabsf(out[s]) > peak ? fabsf(out[s]) : peak;
        }
        MUST(peak > 0);
        REFUSED_BY_STATUS(asp_find(scene, ASP_BODY, "gong", &body), ASP_UNKNOWN, "gong");
        MUST(asp_scene_free(scene) == ASP_OK && asp_renderer_free(renderer) == ASP_OK);
    }
    return NULL;
}

static void many(void) {
    pthread_t all[64];
    const size_t count_of_threads = few ? 8 : 64;
    for (size_t i = 0; i < count_of_threads; i++)
        MUST(pthread_create(&all[i], NULL, own_engine, (void *)i) == 0);
    for (size_t i = 0; i < count_of_threads; i++)
        MUST(pthread_join(all[i], NULL) == 0);
    asp_scene *scene;
    asp_renderer *renderer;
    build(&scene, &renderer);
    asp_port_config wanted;
    asp_port_config_init(&wanted);
    asp_port *ports[1025];
    int count = 0;
    int32_t status = ASP_OK;
    while (count < 1025 && (status = asp_open_port(scene, &wanted, &ports[count])) == ASP_OK)
        count++;
    MUST(status == ASP_FULL && count >= 1 && asp_last_error()[0]);
    while (count > 0)
        MUST(asp_port_free(ports[--count]) == ASP_OK);
    MUST(asp_scene_free(scene) == ASP_OK && asp_renderer_free(renderer) == ASP_OK);
}

/* A hand that comes down on a plane, presses, and is taken away. */
static void tips(void) {
    asp_scene *scene;
    asp_renderer *renderer;
    build(&scene, &renderer);
    uint64_t flat = plane(scene, bell(scene));
    asp_tip *tip;
    REFUSED(asp_tip_new(scene, &flat, 1, NAN, NAN, NAN, &tip), ASP_REFUSED, "frame");
    asp_surface surface;
    asp_surface_init(&surface);
    surface.width_m = surface.height_m = 0.1;
    surface.table = "frame = { origin_m = [0.0, 0.0, 0.0], u_axis = [1.0, 0.0, 0.0], v_axis = [0.0, 1.0, 0.0] }";
    uint64_t id = 0;
    MUST(asp_add_surface(scene, &surface, &id) == ASP_OK);
    MUST(asp_tip_new(scene, &id, 1, 400.0, NAN, NAN, &tip) == ASP_OK && tip);
    asp_event event;
    asp_event_init(&event);
    uint32_t kinds[4] = {0};
    for (int n = 0; n < 90; n++) {
        double height_m = 0.01 - 0.0005 * n;
        double at_m[3] = {0.02 + 0.0003 * n, 0.05, height_m > -0.002 ? height_m : -0.002};
        MUST(asp_tip_step(tip, 1.0 / 90.0, at_m, 7, -1, &event) == ASP_OK && event.kind <= ASP_END);
        kinds[event.kind]++;
        if (event.kind != 0) MUST(asp_report(scene, n / 90.0, &event, 1, sizeof event, NULL) == ASP_OK);
    }
    MUST(kinds[ASP_BEGIN] == 1 && kinds[ASP_MOVE] > 60 && kinds[ASP_END] == 0);
    MUST(fabs(event.normal_force_n - 0.8) < 1e-9 && fabs(event.velocity_m_s[0] - 0.027) < 1e-4);
    double nowhere[3] = {NAN, 0, 0};
    REFUSED(asp_tip_step(tip, 0.01, nowhere, 7, -1, &event), ASP_REFUSED, "position_m");
    MUST(asp_tip_lift(tip, 7, &event) == ASP_OK && event.kind == ASP_END && event.contact == 7);
    MUST(asp_tip_lift(tip, 7, &event) == ASP_OK && event.kind == 0);
    MUST(asp_tip_free(tip) == ASP_OK);
    REFUSED(asp_tip_lift(tip, 7, &event), ASP_BAD_HANDLE, "tip");
    MUST(asp_scene_free(scene) == ASP_OK && asp_renderer_free(renderer) == ASP_OK);
}

int main(int count, char **words) {
    few = count > 1 && strcmp(words[1], "few") == 0;
    nulls(), sizes(), ids_and_numbers(), handles(), threads(), callbacks(), texts(), many(), tips();
    printf("hostile: %d refusals, each with a status and a sentence; %d calls met a busy handle\n", refusals_, atomic_load(&busy));
    return 0;
}
