/* Live haptics of a headset's controllers: the points of a port (ASP_PORT_POINTS) as frames of XR_EXT_haptic_parametric, or as plain
 * vibrations where the runtime has no such extension. Header only; nothing links OpenXR, the caller hands over the runtime's functions:
 *
 *     #include <openxr/openxr.h>
 *     #include <asperity.h>
 *     #include <asperity_openxr.h>
 *
 *     asp_port_config points;
 *     asp_port_config_init(&points);
 *     points.kind = ASP_PORT_POINTS, points.index = 0;       // haptic channel 0, 100 points a second, 55 to 200 Hz
 *     asp_open_port(scene, &points, &port);
 *     asp_xr_hand right;
 *     asp_xr_init(&right, port, &points, apply, stop);       // of xrGetInstanceProcAddr
 *     asp_xr_session(&right, session, action, right_path);   // and again for every new session
 *     asp_xr_parametric(&right, 50000000);                   // where the extension is on: minimumFirstFrameDuration
 *     ...
 *     asp_xr_tick(&right, seconds);                          // every frame, on the thread that calls OpenXR
 *
 * A stream begins with the first point that is felt, whose level the first frame holds for as long as the runtime wants its first frame to
 * be; later points lag by that. It ends after 0.1 s of silence. Points that cannot be played are counted: `unfocused` while the session has no
 * focus, `dropped` where the port's reader came too late or the engine's clock runs ahead of the runtime's. */
#ifndef ASPERITY_OPENXR_H
#define ASPERITY_OPENXR_H

#ifdef __cplusplus
extern "C" {
#endif

/* As XR_EXT_haptic_parametric of OpenXR 1.1.60 has them, which older headers lack. */
#define ASP_XR_TYPE_PARAMETRIC_VIBRATION ((XrStructureType)1000775000)
#define ASP_XR_MOST_POINTS 500
/* Time for which a runtime holds the last values of a stream, ns. */
#define ASP_XR_HELD_NS 50000000
/* Points of one call of asp_xr_tick. */
#define ASP_XR_AT_ONCE 128

enum { ASP_XR_WHOLE = 0, ASP_XR_FIRST = 1, ASP_XR_INTERMEDIATE = 2, ASP_XR_LAST = 3 };

typedef struct asp_xr_value {
    XrDuration time;
    float value;
} asp_xr_value;

typedef struct asp_xr_transient {
    XrDuration time;
    float amplitude, frequency;
} asp_xr_transient;

typedef struct asp_xr_vibration {
    XrStructureType type;
    const void *next;
    uint32_t amplitude_count;
    const asp_xr_value *amplitudes;
    uint32_t frequency_count;
    const asp_xr_value *frequencies;
    uint32_t transient_count;
    const asp_xr_transient *transients;
    float min_frequency_hz, max_frequency_hz;
    int32_t stream_frame_type;
} asp_xr_vibration;

/* One controller. Settings may be changed between two ticks; what follows them is the helper's own, to be read. */
typedef struct asp_xr_hand {
    /* Sample value that counts as amplitude 1. */
    double full_scale;
    /* Amplitude below which nothing is felt. */
    double floor;
    asp_port *port;
    double rate_hz, low_hz, high_hz;
    PFN_xrApplyHapticFeedback apply;
    PFN_xrStopHapticFeedback stop;
    XrSession session;
    XrHapticActionInfo info;
    int parametric;
    XrDuration first_frame_ns;

    int streams;
    uint64_t first_tick;
    double began_s;
    XrDuration last_ns, silent_since_ns;
    uint64_t lost_before;
    /* Counts: calls, points played, points of silence that need no call, and what was not played. */
    uint64_t calls, played, silent, unfocused, dropped, refused;
    /* What the runtime answered last. */
    XrResult last;
} asp_xr_hand;

/* `settings` are those that the port was opened with. */
static inline void asp_xr_init(asp_xr_hand *hand, asp_port *port, const asp_port_config *settings, PFN_xrApplyHapticFeedback apply,
                               PFN_xrStopHapticFeedback stop) {
    memset(hand, 0, sizeof *hand);
    hand->full_scale = 1.0, hand->floor = 1.0 / 256.0;
    hand->port = port, hand->rate_hz = settings->rate_hz;
    hand->low_hz = settings->low_hz, hand->high_hz = settings->high_hz;
    hand->apply = apply, hand->stop = stop;
}

/* A session has begun: what was streamed to another is over. */
static inline void asp_xr_session(asp_xr_hand *hand, XrSession session, XrAction action, XrPath subaction) {
    memset(&hand->info, 0, sizeof hand->info);
    hand->info.type = XR_TYPE_HAPTIC_ACTION_INFO;
    hand->info.action = action, hand->info.subactionPath = subaction;
    hand->session = session, hand->streams = 0;
}

/* The extension is on, and xrHapticParametricGetPropertiesEXT has said how long a first frame has to be (0: as short as it may). */
static inline void asp_xr_parametric(asp_xr_hand *hand, XrDuration first_frame_ns) {
    XrDuration least = (XrDuration)(1e9 / hand->rate_hz);
    hand->parametric = 1;
    hand->first_frame_ns = first_frame_ns > least ? first_frame_ns : least;
}

static inline float asp_xr_share(double x) { return x > 0.0 ? (x < 1.0 ? (float)x : 1.0f) : 0.0f; }

/* One call; counts what it carries by the runtime's answer. */
static inline XrResult asp_xr_send(asp_xr_hand *hand, const void *vibration, uint64_t points) {
    hand->last = hand->apply(hand->session, &hand->info, (const XrHapticBaseHeader *)vibration);
    hand->calls++;
    if (hand->last == XR_SESSION_NOT_FOCUSED)
        hand->unfocused += points;
    else if (hand->last < 0)
        hand->refused += points;
    else
        hand->played += points;
    if (hand->last != XR_SUCCESS)
        hand->streams = 0;
    return hand->last;
}

static inline XrResult asp_xr_frame(asp_xr_hand *hand, const asp_xr_value *levels, const asp_xr_value *tones, uint32_t count,
                                    uint64_t points, int type) {
    asp_xr_vibration frame;
    memset(&frame, 0, sizeof frame);
    frame.type = ASP_XR_TYPE_PARAMETRIC_VIBRATION;
    frame.amplitude_count = frame.frequency_count = count;
    frame.amplitudes = levels, frame.frequencies = tones;
    if (type == ASP_XR_FIRST)
        frame.min_frequency_hz = (float)hand->low_hz, frame.max_frequency_hz = (float)hand->high_hz;
    frame.stream_frame_type = type;
    hand->last_ns = levels[count - 1].time;
    hand->streams = type != ASP_XR_LAST;
    return asp_xr_send(hand, &frame, points);
}

/* Frames of points that are at hand. */
static inline XrResult asp_xr_stream(asp_xr_hand *hand, const asp_point *points, uint32_t count, double now_s) {
    asp_xr_value levels[ASP_XR_AT_ONCE + 2], tones[ASP_XR_AT_ONCE + 2];
    uint32_t filled = 0;
    uint64_t carried = 0;
    int type = ASP_XR_INTERMEDIATE;
    /* A stream that the runtime has run dry of is over. */
    if (hand->streams && (now_s - hand->began_s) * 1e9 > (double)(hand->last_ns + ASP_XR_HELD_NS / 2))
        hand->streams = 0;
    /* After a hitch only what is new is felt: a stream that began with old points would lag for good. */
    uint32_t from = 0, newest = (uint32_t)(hand->rate_hz * 0.05) + 1;
    if (!hand->streams && count > newest)
        for (; from < count - newest; from++)
            *(points[from].amplitude >= hand->floor * hand->full_scale ? &hand->dropped : &hand->silent) += 1;
    for (uint32_t at = from; at < count; at++) {
        float level = asp_xr_share(points[at].amplitude / hand->full_scale);
        float tone = asp_xr_share((points[at].frequency_hz - hand->low_hz) / (hand->high_hz - hand->low_hz));
        int felt = level >= hand->floor;
        if (!hand->streams && type != ASP_XR_FIRST) {
            if (!felt) {
                hand->silent++;
                continue;
            }
            type = ASP_XR_FIRST;
            hand->first_tick = points[at].tick, hand->began_s = now_s;
            hand->silent_since_ns = 0;
            levels[0].time = tones[0].time = 0;
            levels[1].time = tones[1].time = hand->first_frame_ns;
            levels[0].value = levels[1].value = level, tones[0].value = tones[1].value = tone;
            filled = 2, carried = 1;
            continue;
        }
        XrDuration time = hand->first_frame_ns + (XrDuration)((double)(points[at].tick - hand->first_tick) * 1e9 / hand->rate_hz);
        if (felt)
            hand->silent_since_ns = time;
        /* Further ahead than a burst makes it: the engine's clock is the faster one. */
        if ((double)time * 1e-9 - (now_s - hand->began_s) > 0.1 + (double)hand->first_frame_ns * 1e-9) {
            hand->dropped++;
            continue;
        }
        levels[filled].time = tones[filled].time = time;
        levels[filled].value = level, tones[filled].value = tone;
        filled++, carried++;
    }
    if (filled == 0)
        return XR_SUCCESS;
    if (type == ASP_XR_INTERMEDIATE && levels[filled - 1].time - hand->silent_since_ns > 100000000) {
        levels[filled - 1].value = 0.0f;
        type = ASP_XR_LAST;
    }
    return asp_xr_frame(hand, levels, tones, filled, carried, type);
}

/* Without the extension: the strongest of the points as one vibration that outlasts two frames. */
static inline XrResult asp_xr_plain(asp_xr_hand *hand, const asp_point *points, uint32_t count) {
    XrHapticVibration vibration;
    double level = 0.0;
    memset(&vibration, 0, sizeof vibration);
    vibration.type = XR_TYPE_HAPTIC_VIBRATION;
    for (uint32_t at = 0; at < count; at++) {
        if (points[at].amplitude / hand->full_scale > level) {
            level = points[at].amplitude / hand->full_scale;
            vibration.frequency = (float)points[at].frequency_hz;
        }
    }
    vibration.amplitude = asp_xr_share(level);
    vibration.duration = 2 * (XrDuration)(1e9 / hand->rate_hz) + 25000000;
    if (level < hand->floor) {
        int was = hand->streams;
        hand->silent += count, hand->streams = 0;
        return was ? hand->stop(hand->session, &hand->info) : XR_SUCCESS;
    }
    hand->streams = 1;
    return asp_xr_send(hand, &vibration, count);
}

/* Hands over what has come since the last call; `now_s` is any clock that only rises. The runtime's last answer. */
static inline XrResult asp_xr_tick(asp_xr_hand *hand, double now_s) {
    asp_point points[ASP_XR_AT_ONCE];
    XrResult result = XR_SUCCESS;
    uint64_t lost = asp_port_lost(hand->port);
    hand->dropped += lost - hand->lost_before;
    hand->lost_before = lost;
    for (;;) {
        uint32_t count = asp_port_points(hand->port, points, ASP_XR_AT_ONCE);
        if (count == 0)
            return result;
        result = hand->parametric ? asp_xr_stream(hand, points, count, now_s) : asp_xr_plain(hand, points, count);
    }
}

/* Ends what is felt at once. */
static inline XrResult asp_xr_stop(asp_xr_hand *hand) {
    hand->streams = 0;
    return hand->stop(hand->session, &hand->info);
}

#ifdef __cplusplus
}
#endif
#endif
