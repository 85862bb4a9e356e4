/* Live haptics against a runtime that is none: it judges each call by the rules of XR_EXT_haptic_parametric (OpenXR 1.1.60),
 * XR_FB_haptic_pcm, XR_FB_haptic_amplitude_envelope and XrHapticVibration, loses its focus and its session, and plays in a time of its own. Nothing here links OpenXR.
 *
 *     headset FRAMES           calls the runtime itself
 *     headset FRAMES LOADER    through OpenXR's loader, a library, and the runtime of XR_RUNTIME_JSON (openxr_runtime.c), with what layers there are
 *     headset FRAMES LOADER plain    without parametric frames, which older layers know nothing of */
#include <dlfcn.h>
#include <math.h>
#include <openxr/openxr.h>

#include "common.h"
#include <asperity_openxr.h>

/* The helper's structs are those of a header that has them. */
#ifdef XR_EXT_haptic_parametric
#define SAME(ours, theirs, last, its_last)                                                                                                   \
    typedef char same_##ours[sizeof(ours) == sizeof(theirs) && offsetof(ours, last) == offsetof(theirs, its_last) ? 1 : -1];
SAME(asp_xr_vibration, XrHapticParametricVibrationEXT, stream_frame_type, streamFrameType)
SAME(asp_xr_piece, XrHapticPcmVibrationFB, consumed, samplesConsumed)
SAME(asp_xr_levels, XrHapticAmplitudeEnvelopeVibrationFB, amplitudes, amplitudes)
typedef char same_types[ASP_XR_TYPE_PARAMETRIC_VIBRATION == XR_TYPE_HAPTIC_PARAMETRIC_VIBRATION_EXT && ASP_XR_TYPE_PCM_VIBRATION == XR_TYPE_HAPTIC_PCM_VIBRATION_FB && ASP_XR_TYPE_ENVELOPE_VIBRATION == XR_TYPE_HAPTIC_AMPLITUDE_ENVELOPE_VIBRATION_FB ? 1 : -1];
#endif

#define RATE 48000.0
#define BLOCK 128

#include "headset_judge.h"

/* Ways to it: its own functions, or those that the loader gives. */
static PFN_xrApplyHapticFeedback apply = judged_apply;
static PFN_xrStopHapticFeedback stop = judged_stop;
static PFN_xrCreateSession create_session;
static XrInstance instance;
static XrAction action = (XrAction)(uintptr_t)7;

static PFN_xrVoidFunction found(PFN_xrGetInstanceProcAddr find, const char *name) {
    PFN_xrVoidFunction function = NULL;
    if (find(instance, name, &function) != XR_SUCCESS || function == NULL) {
        fprintf(stderr, "the loader has no %s\n", name);
        exit(1);
    }
    return function;
}

static void through(const char *loader) {
    const char *extensions[] = {"XR_MND_headless", asp_xr_name(ASP_XR_ENVELOPE), asp_xr_name(ASP_XR_PCM), asp_xr_name(ASP_XR_PARAMETRIC)};
    static XrExtensionProperties offered[8];
    uint32_t count = 0;
    void *library = dlopen(loader, RTLD_NOW);
    PFN_xrGetInstanceProcAddr find;
    MUST(library != NULL);
    *(void **)&find = dlsym(library, "xrGetInstanceProcAddr");
    MUST(find != NULL);
    for (int at = 0; at < 8; at++)
        offered[at].type = XR_TYPE_EXTENSION_PROPERTIES;
    MUST(((PFN_xrEnumerateInstanceExtensionProperties)found(find, "xrEnumerateInstanceExtensionProperties"))(NULL, 8, &count, offered) == XR_SUCCESS);
    MUST(asp_xr_best(offered, count) == ASP_XR_PARAMETRIC);
    XrInstanceCreateInfo wanted;
    memset(&wanted, 0, sizeof wanted);
    wanted.type = XR_TYPE_INSTANCE_CREATE_INFO;
    strcpy(wanted.applicationInfo.applicationName, "headset"), strcpy(wanted.applicationInfo.engineName, "asperity");
    wanted.applicationInfo.apiVersion = XR_MAKE_VERSION(1, 0, 20);
    wanted.enabledExtensionCount = 4, wanted.enabledExtensionNames = extensions;
    MUST(((PFN_xrCreateInstance)found(find, "xrCreateInstance"))(&wanted, &instance) == XR_SUCCESS);
    XrActionSet set;
    XrActionSetCreateInfo hands;
    memset(&hands, 0, sizeof hands);
    hands.type = XR_TYPE_ACTION_SET_CREATE_INFO;
    strcpy(hands.actionSetName, "hands"), strcpy(hands.localizedActionSetName, "Hands");
    MUST(((PFN_xrCreateActionSet)found(find, "xrCreateActionSet"))(instance, &hands, &set) == XR_SUCCESS);
    XrActionCreateInfo feels;
    memset(&feels, 0, sizeof feels);
    feels.type = XR_TYPE_ACTION_CREATE_INFO, feels.actionType = XR_ACTION_TYPE_VIBRATION_OUTPUT;
    strcpy(feels.actionName, "haptic"), strcpy(feels.localizedActionName, "Haptic");
    MUST(((PFN_xrCreateAction)found(find, "xrCreateAction"))(set, &feels, &action) == XR_SUCCESS);
    create_session = (PFN_xrCreateSession)found(find, "xrCreateSession");
    apply = (PFN_xrApplyHapticFeedback)found(find, "xrApplyHapticFeedback");
    stop = (PFN_xrStopHapticFeedback)found(find, "xrStopHapticFeedback");
}

static XrSession opened(void) {
    if (!create_session)
        return (XrSession)(uintptr_t)judged_session();
    XrSession session;
    XrSessionCreateInfo wanted;
    memset(&wanted, 0, sizeof wanted);
    wanted.type = XR_TYPE_SESSION_CREATE_INFO, wanted.systemId = 1;
    MUST(create_session(instance, &wanted, &session) == XR_SUCCESS);
    return session;
}

/* The game: a finger on a rough plate, and a bell. */
static asp_scene *scene;
static asp_renderer *renderer;
static asp_port *port;
static uint64_t bell, plate;
static double time_s;

static void build(double points_hz, int way, asp_port_config *settings) {
    asp_config config;
    asp_config_init(&config);
    config.sample_rate_hz = RATE, config.clock = ASP_CLOCK_EXACT;
    MUST(asp_build(&config, &scene, &renderer) == ASP_OK);
    asp_body body;
    asp_init_body(&body, sizeof body);
    body.stock = "bar", body.size_m = 0.2;
    MUST(asp_add_body(scene, &body, &bell) == ASP_OK);
    asp_surface surface;
    asp_surface_init(&surface);
    surface.table = "solid = \"granite\"\nwidth_m = 0.2\nheight_m = 0.2\nrelief_m = 2e-4\n";
    MUST(asp_add_surface(scene, &surface, &plate) == ASP_OK);
    asp_port_config_init(settings);
    settings->kind = way == ASP_XR_PCM ? ASP_PORT_PCM : ASP_PORT_POINTS, settings->rate_hz = points_hz, settings->holds_s = 1.0;
    MUST(asp_open_port(scene, settings, &port) == ASP_OK);
    time_s = 0.0;
}

static void away(void) {
    MUST(asp_port_free(port) == ASP_OK && asp_scene_free(scene) == ASP_OK && asp_renderer_free(renderer) == ASP_OK);
}

static void report(uint32_t kind, double speed_m_s) {
    asp_event event;
    asp_init_event(&event, sizeof event);
    event.kind = kind, event.contact = 1, event.surface = plate, event.actuator = 0;
    event.uv[0] = fmod(0.1 + speed_m_s * time_s / 0.2, 0.8), event.uv[1] = 0.5;
    event.velocity_m_s[0] = speed_m_s, event.velocity_m_s[1] = 0.0, event.normal_force_n = 1.0;
    if (kind == ASP_IMPACT)
        event.body = bell, event.striker = 0;
    MUST(asp_report(scene, time_s, &event, 1, sizeof event, NULL) == ASP_OK);
}

static float frame[2 * BLOCK];

static void render(void) {
    int32_t map[2] = {0, ASP_HAPTIC};
    asp_render_interleaved(renderer, frame, 2, BLOCK, map);
    time_s += BLOCK / RATE;
}

static void begin(double first_frame_s, int way) {
    memset(&runtime, 0, sizeof runtime);
    runtime.focused = 1, runtime.way = way, runtime.room = 4000.0;
    runtime.first_frame_ns = (XrDuration)(first_frame_s * 1e9), runtime.first_call_s = -1.0;
}

static double now(double drift) { return 40.0 + time_s * (1.0 + drift); }

/* A hand whose controller is reached one way. */
static void held(asp_xr_hand *hand, const asp_port_config *settings, double full_scale) {
    asp_xr_init(hand, port, settings, apply, stop);
    asp_xr_session(hand, opened(), action, 1);
    if (runtime.way == ASP_XR_PARAMETRIC)
        asp_xr_parametric(hand, runtime.first_frame_ns);
    if (runtime.way == ASP_XR_ENVELOPE)
        asp_xr_envelope(hand);
    if (runtime.way == ASP_XR_PCM) {
        MUST(!asp_xr_pcm(hand, RATE, 0.0) && asp_xr_tick(hand, now(0.0)) == XR_SUCCESS && hand->calls == 0);
        MUST(asp_xr_pcm(hand, RATE, PCM_HZ));
    }
    hand->full_scale = full_scale;
}

/* Strokes that come and go, in a clock that drifts, with hitches of the game, focus lost and a new session. */
static void frames(uint64_t wanted, double first_frame_s, double drift, int way) {
    asp_port_config settings;
    asp_xr_hand hand;
    int parametric = way == ASP_XR_PARAMETRIC;
    build(100.0, way, &settings);
    begin(first_frame_s, way);
    held(&hand, &settings, 0.05);
    uint64_t unread = 0;
    for (uint64_t block = 0; runtime.frames + runtime.plain < wanted; block++) {
        int touches = block % 2000 < 1700;
        if (block % 6 == 0 && touches)
            report(block % 2000 < 6 ? ASP_BEGIN : ASP_MOVE, 0.12);
        if (block % 2000 == 1700)
            report(ASP_END, 0.0);
        render();
        runtime.now_s = now(drift);
        /* The game stands still for 0.3 s, and once for longer than the port holds. */
        if (block % 5000 > 4880 || (block > 20000 && block < 20600)) {
            unread++;
            continue;
        }
        if (block % 7000 == 3000)
            runtime.focused = 0;
        if (block % 7000 == 3100)
            runtime.focused = 1;
        if (block % 9000 == 8000) {
            /* The session is lost, and 50 blocks later there is another. */
            runtime.session = 0, runtime.streams = 0;
        }
        if (block % 9000 == 8050)
            asp_xr_session(&hand, opened(), action, 1);
        /* Little room for a while: what was not taken comes again. */
        runtime.room = block % 3000 < 300 ? 30.0 : 4000.0;
        asp_xr_tick(&hand, now(drift));
        if (runtime.broken) {
            fprintf(stderr, "frame %llu: %s\n", (unsigned long long)runtime.frames, runtime.rule);
            exit(1);
        }
    }
    /* Nothing is lost that is not counted. */
    asp_stats stats;
    asp_init_stats(&stats, sizeof stats);
    MUST(asp_get_stats(scene, &stats) == ASP_OK);
    uint64_t made = (uint64_t)((double)stats.position / RATE * (way == ASP_XR_PCM ? PCM_HZ : settings.rate_hz));
    uint64_t told = hand.played + hand.silent + hand.unfocused + hand.refused + hand.dropped + hand.waiting;
    MUST(told <= made + 1 && told + 2 >= made);
    MUST(way == ASP_XR_PLAIN || way == ASP_XR_PCM || runtime.played_amplitude > 0.1);
    /* Nothing stands between the call and the runtime. */
    MUST(hand.calls == runtime.calls && hand.calls > 0);
    MUST(time_s < 30.0 || (hand.silent > 0 && (!parametric || (runtime.lasts > 0 && hand.dropped > 0)) && hand.unfocused > 0 && hand.refused > 0));
    printf("%s: %llu frames, %llu points, %llu streams: none refused by a rule; %llu points without focus, %llu without a session, %llu dropped\n",
           way ? asp_xr_name(way) : "plain", (unsigned long long)(runtime.frames + runtime.plain), (unsigned long long)hand.played, (unsigned long long)runtime.firsts,
           (unsigned long long)hand.unfocused, (unsigned long long)hand.refused, (unsigned long long)hand.dropped);
    away();
}

static int rising(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* From a report to the call that carries it, in the time of the audio: a game of 60 ticks a second that calls asp_xr_tick each block. */
static void latency(int way) {
    static double waits_s[200];
    asp_port_config settings;
    asp_xr_hand hand;
    build(200.0, way, &settings);
    begin(0.05, way);
    held(&hand, &settings, 1e-2);
    for (int strike = 0; strike < 200; strike++) {
        /* Until all is silent, then a little more, so that strikes fall anywhere between two points. */
        for (int block = 0; block < 400 + strike % 7; block++) {
            render(), runtime.now_s = now(0.0);
            asp_xr_tick(&hand, now(0.0));
        }
        runtime.first_call_s = -1.0;
        double reported_s = now(0.0);
        report(ASP_IMPACT, 0.0);
        for (int block = 0; block < 400 && runtime.first_call_s < 0.0; block++) {
            render(), runtime.now_s = now(0.0);
            asp_xr_tick(&hand, now(0.0));
        }
        MUST(runtime.first_call_s > 0.0 && runtime.broken == 0);
        waits_s[strike] = runtime.first_call_s - reported_s;
    }
    qsort(waits_s, 200, sizeof *waits_s, rising);
    printf("%s: from a report to its call %.1f ms at the median, %.1f ms at p99\n", way ? asp_xr_name(way) : "plain",
           1e3 * waits_s[100], 1e3 * waits_s[198]);
    MUST(waits_s[198] <= 0.02);
    MUST(asp_xr_stop(&hand) == XR_SUCCESS);
    away();
}

/* Power within a band of 2 s, Hz. */
static double power(const float *samples, double rate_hz, double low_hz, double high_hz) {
    double sum = 0.0;
    int count = (int)(2.0 * rate_hz);
    for (int bin = (int)ceil(2.0 * low_hz); bin < 2.0 * high_hz; bin++) {
        double turn = 2.0 * acos(-1.0) * bin / count, re = 0.0, im = 0.0;
        for (int at = 0; at < count; at++)
            re += samples[at] * cos(turn * at), im += samples[at] * sin(turn * at);
        sum += (re * re + im * im) / ((double)count * count);
    }
    return sum;
}

/* A stroke of 2 s as it leaves the engine, and as a runtime has it. */
static void same_wave(void) {
    static float left[144000];
    asp_port_config settings;
    asp_xr_hand hand;
    build(100.0, ASP_XR_PCM, &settings);
    begin(0.0, ASP_XR_PCM);
    held(&hand, &settings, 0.6);
    uint32_t count = 0;
    for (uint64_t block = 0; block < 750; block++) {
        if (block % 6 == 0)
            report(block == 0 ? ASP_BEGIN : ASP_MOVE, 0.12);
        render(), runtime.now_s = now(0.0);
        for (int at = 0; at < BLOCK; at++)
            left[count++] = frame[2 * at + 1] / 0.6f;
        /* A game of 94 frames a second. */
        if (block % 4 == 3)
            asp_xr_tick(&hand, now(0.0));
    }
    MUST(runtime.broken == 0 && runtime.begun == 1 && runtime.taken >= 4000);
    double worst_db = 0.0;
    for (double hz = 63.0; hz < 520.0; hz *= cbrt(2.0)) {
        double edge = pow(2.0, 1.0 / 6.0), was = power(left, RATE, hz / edge, hz * edge), is = power(runtime.wave, PCM_HZ, hz / edge, hz * edge);
        worst_db = fmax(worst_db, fabs(10.0 * log10(is / was)));
    }
    printf("a waveform at %.0f Hz: third octaves from 63 to 500 Hz within %.2f dB of what left\n", PCM_HZ, worst_db);
    MUST(worst_db <= 1.0);
    away();
}

static void chooses(void) {
    static XrExtensionProperties offered[3];
    for (int way = ASP_XR_ENVELOPE; way <= ASP_XR_PARAMETRIC; way++) {
        MUST(asp_xr_best(offered, 3) == way - 1);
        strcpy(offered[way - 1].extensionName, asp_xr_name(way));
    }
    MUST(asp_xr_best(offered, 3) == ASP_XR_PARAMETRIC && asp_xr_name(ASP_XR_PLAIN) == NULL);
}

int main(int count, char **words) {
    uint64_t wanted = count > 1 ? strtoull(words[1], NULL, 10) : 100000;
    int newest = count < 4 ? ASP_XR_PARAMETRIC : ASP_XR_PLAIN;
    judges(), chooses();
    if (count > 2)
        through(words[2]);
    frames(wanted, 0.05, 0.0, newest);
    frames(wanted / 20, 0.0, 3e-4, newest);
    for (int way = ASP_XR_PLAIN; way <= newest; way++)
        frames(way == ASP_XR_PCM ? 2 * wanted : wanted / 20, 0.12, -3e-4, way), latency(way);
    if (newest > ASP_XR_PLAIN)
        same_wave();
    puts("headset: every call keeps the rules");
    return 0;
}
