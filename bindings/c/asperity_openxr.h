/* Live haptics of a headset's controllers, by the best of what its runtime offers: frames of XR_EXT_haptic_parametric, the waveform by
 * XR_FB_haptic_pcm, levels by XR_FB_haptic_amplitude_envelope, or plain vibrations. Header only; nothing links OpenXR, the caller hands over
 * the runtime's functions:
 *
 *     #include <openxr/openxr.h>
 *     #include <asperity.h>
 *     #include <asperity_openxr.h>
 *
 *     int way = asp_xr_best(offered, count);                 // of xrEnumerateInstanceExtensionProperties; enable asp_xr_name(way)
 *     asp_port_config port_config;
 *     asp_port_config_init(&port_config);                    // haptic channel 0; points 100 times a second, 55 to 200 Hz
 *     port_config.kind = way == ASP_XR_PCM ? ASP_PORT_PCM : ASP_PORT_POINTS;
 *     asp_open_port(scene, &port_config, &port);
 *     asp_xr_hand right;
 *     asp_xr_init(&right, port, &port_config, apply, stop);  // of xrGetInstanceProcAddr
 *     asp_xr_session(&right, session, action, right_path);   // and again for every new session
 *     asp_xr_parametric(&right, 50000000);                   // that way: minimumFirstFrameDuration
 *     asp_xr_pcm(&right, 48000, rate_hz);                    // or: the engine's rate, and that of xrGetDeviceSampleRateFB
 *     asp_xr_envelope(&right);                               // or; none of the three: plain vibrations
 *     ...
 *     asp_xr_tick(&right, seconds);                          // every frame, on the thread that calls OpenXR
 *
 * A stream begins with the first point that is felt; the first frame is as long as the runtime wants it to be and silent until that point,
 * with which it ends; everything lags by that. A waveform begins with 20 ms of silence, which carry it over frames that come late. Both end
 * after 0.1 s of silence. What cannot be played is counted: `unfocused` while the session has no focus, `dropped` where the port's reader
 * came too late or the engine's clock runs ahead of the runtime's. */
#ifndef ASPERITY_OPENXR_H
#define ASPERITY_OPENXR_H

#include <math.h>
#include <string.h>

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

/* As XR_FB_haptic_amplitude_envelope and XR_FB_haptic_pcm have them. */
#define ASP_XR_TYPE_ENVELOPE_VIBRATION ((XrStructureType)1000173001)
#define ASP_XR_TYPE_PCM_VIBRATION ((XrStructureType)1000209001)
/* Silence before a waveform, and what waits of it, in samples of the runtime's rate at most. */
#define ASP_XR_LEAD 160
#define ASP_XR_WAITING 1024
/* Ways to a controller. */
enum { ASP_XR_PLAIN = 0, ASP_XR_ENVELOPE = 1, ASP_XR_PCM = 2, ASP_XR_PARAMETRIC = 3 };
/* Position of a frame in its stream. */
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
typedef struct asp_xr_levels {
    XrStructureType type;
    const void *next;
    XrDuration duration;
    uint32_t count;
    const float *amplitudes;
} asp_xr_levels;
typedef struct asp_xr_piece {
    XrStructureType type;
    const void *next;
    uint32_t count;
    const float *samples;
    float rate_hz;
    XrBool32 append;
    uint32_t *consumed;
} asp_xr_piece;

/* One controller. Settings may be changed between two ticks; what follows them is the helper's own, to be read. */
typedef struct asp_xr_hand {
    /* Sample value that counts as amplitude 1, and amplitude below which nothing is felt. */
    double full_scale, floor;
    asp_port *port;
    double rate_hz, low_hz, high_hz;
    PFN_xrApplyHapticFeedback apply;
    PFN_xrStopHapticFeedback stop;
    XrSession session;
    XrHapticActionInfo info;
    int way;
    XrDuration first_frame_ns;
    /* A waveform on its way to the runtime's rate: a low-pass of four sections, and the samples that wait behind a silence. */
    double to_hz, ratio, phase, before, sections[4][5], state[4][2];
    float samples[ASP_XR_LEAD + ASP_XR_WAITING];
    uint32_t waiting;
    uint64_t quiet, sent;
    int streams;
    uint64_t first_tick;
    double began_s, tone; /* tone: of the point before */
    XrDuration last_ns, silent_since_ns;
    uint64_t lost_before;
    /* Counts: calls, points (of a waveform: samples) played, those of silence that need no call, and what was not played. */
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
    hand->way = ASP_XR_PARAMETRIC;
    hand->first_frame_ns = first_frame_ns > least ? first_frame_ns : least;
}

/* The amplitude envelope's extension is on. */
static inline void asp_xr_envelope(asp_xr_hand *hand) { hand->way = ASP_XR_ENVELOPE; }

/* PCM's extension is on, and the port is one of ASP_PORT_PCM: the engine's rate and the controller's. That is 0 until one is held: 0 then,
 * nothing is played, and it is asked for again. */
static inline int asp_xr_pcm(asp_xr_hand *hand, double from_hz, double to_hz) {
    hand->way = ASP_XR_PCM;
    hand->to_hz = 0.0;
    if (!(to_hz >= 200.0 && to_hz <= 8000.0 && to_hz <= from_hz))
        return 0;
    /* Butterworth's of the eighth order, from 0.35 of the rate on. */
    double pi = 3.14159265358979323846, w = tan(pi * 0.35 * to_hz / from_hz);
    for (int at = 0; at < 4; at++) {
        double damping = 2.0 * cos(pi * (2 * at + 1) / 16.0), a0 = 1.0 + damping * w + w * w, *c = hand->sections[at];
        c[0] = c[2] = w * w / a0, c[1] = 2.0 * c[0];
        c[3] = 2.0 * (w * w - 1.0) / a0, c[4] = (1.0 - damping * w + w * w) / a0;
    }
    memset(hand->state, 0, sizeof hand->state);
    hand->to_hz = to_hz, hand->ratio = to_hz / from_hz, hand->phase = 0.0, hand->waiting = 0, hand->streams = 0;
    return 1;
}

/* The extension of a way; NULL for plain vibrations. */
static inline const char *asp_xr_name(int way) {
    static const char *names[] = {NULL, "XR_FB_haptic_amplitude_envelope", "XR_FB_haptic_pcm", "XR_EXT_haptic_parametric"};
    return names[way];
}

/* The best way of those that a runtime offers. */
static inline int asp_xr_best(const XrExtensionProperties *offered, uint32_t count) {
    for (int way = ASP_XR_PARAMETRIC; way > ASP_XR_PLAIN; way--)
        for (uint32_t at = 0; at < count; at++)
            if (strcmp(offered[at].extensionName, asp_xr_name(way)) == 0)
                return way;
    return ASP_XR_PLAIN;
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
                hand->silent++, hand->tone = tone;
                continue;
            }
            type = ASP_XR_FIRST;
            hand->first_tick = points[at].tick, hand->began_s = now_s;
            hand->silent_since_ns = 0;
            levels[0].value = levels[1].value = 0.0f, levels[2].value = level, tones[0].value = tones[1].value = (float)hand->tone, tones[2].value = tone;
            levels[0].time = tones[0].time = 0, levels[2].time = tones[2].time = hand->first_frame_ns;
            levels[1].time = tones[1].time = hand->first_frame_ns - (XrDuration)(1e9 / hand->rate_hz);
            filled = 3, carried = 1, hand->tone = tone;
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

/* Without a stream, one vibration that outlasts two frames: the points' levels one after another, or the strongest of them. */
static inline XrResult asp_xr_once(asp_xr_hand *hand, const asp_point *points, uint32_t count) {
    float levels[2 * ASP_XR_AT_ONCE];
    XrHapticVibration vibration;
    asp_xr_levels envelope;
    double level = 0.0;
    memset(&vibration, 0, sizeof vibration), memset(&envelope, 0, sizeof envelope);
    for (uint32_t at = 0; at < count; at++) {
        levels[at] = asp_xr_share(points[at].amplitude / hand->full_scale);
        if (points[at].amplitude / hand->full_scale > level) {
            level = points[at].amplitude / hand->full_scale;
            vibration.frequency = (float)points[at].frequency_hz;
        }
    }
    if (level < hand->floor) {
        int was = hand->streams;
        hand->silent += count, hand->streams = 0;
        return was ? hand->stop(hand->session, &hand->info) : XR_SUCCESS;
    }
    hand->streams = 1;
    if (hand->way == ASP_XR_ENVELOPE) { /* after a hitch only what is new is felt */
        uint32_t newest = (uint32_t)(hand->rate_hz * 0.05) + 1, held = 2 + (uint32_t)(hand->rate_hz * 0.025);
        uint32_t from = count > newest ? count - newest : 0, past = count;
        for (; past < count + held && past < 2 * ASP_XR_AT_ONCE; past++)
            levels[past] = levels[count - 1];
        hand->dropped += from;
        envelope.type = ASP_XR_TYPE_ENVELOPE_VIBRATION;
        envelope.count = past - from, envelope.amplitudes = levels + from;
        envelope.duration = (XrDuration)((double)envelope.count * 1e9 / hand->rate_hz);
        return asp_xr_send(hand, &envelope, count - from);
    }
    vibration.type = XR_TYPE_HAPTIC_VIBRATION;
    vibration.amplitude = asp_xr_share(level);
    vibration.duration = 2 * (XrDuration)(1e9 / hand->rate_hz) + 25000000;
    return asp_xr_send(hand, &vibration, count);
}

/* Leaves out the oldest samples that wait. */
static inline void asp_xr_forget(asp_xr_hand *hand, uint32_t count, uint64_t *counter) {
    *counter += count, hand->waiting -= count;
    memmove(hand->samples + ASP_XR_LEAD, hand->samples + ASP_XR_LEAD + count, hand->waiting * sizeof(float));
}

/* A sample of the runtime's rate; a stream goes on for 0.1 s of silence. */
static inline void asp_xr_take(asp_xr_hand *hand, double y) {
    hand->quiet = fabs(y) >= hand->floor ? 0 : hand->quiet + 1;
    if ((double)hand->quiet > (hand->streams ? 0.1 * hand->to_hz : 0.0) && (hand->streams || hand->waiting == 0)) {
        hand->silent++;
        return;
    }
    if (hand->waiting == ASP_XR_WAITING)
        asp_xr_forget(hand, 1, &hand->dropped);
    hand->samples[ASP_XR_LEAD + hand->waiting++] = (float)(y > -1.0 ? (y < 1.0 ? y : 1.0) : -1.0);
}

static inline void asp_xr_resample(asp_xr_hand *hand, double x) {
    for (int at = 0; at < 4; at++) {
        const double *c = hand->sections[at];
        double *z = hand->state[at], y = c[0] * x + z[0];
        z[0] = c[1] * x - c[3] * y + z[1], z[1] = c[2] * x - c[4] * y;
        x = y;
    }
    hand->phase += hand->ratio;
    if (hand->phase >= 1.0) {
        hand->phase -= 1.0;
        asp_xr_take(hand, x + hand->phase / hand->ratio * (hand->before - x));
    }
    hand->before = x;
}

/* The waveform since the last call; what the runtime has no room for is sent again. */
static inline XrResult asp_xr_wave(asp_xr_hand *hand, double now_s, uint64_t lost) {
    float read[256];
    uint64_t counted = 0;
    uint32_t consumed = 0, lead = 0, newest = (uint32_t)(0.05 * hand->to_hz);
    hand->lost_before += lost, hand->phase += (double)lost * hand->ratio;
    hand->dropped += (uint64_t)hand->phase, hand->phase -= floor(hand->phase);
    for (uint32_t count; (count = asp_port_pcm(hand->port, read, 256)) > 0;)
        for (uint32_t at = 0; at < count; at++)
            asp_xr_resample(hand, read[at] / hand->full_scale);
    double ahead_s = (double)hand->sent / hand->to_hz - (now_s - hand->began_s);
    /* A stream that the runtime has run dry of begins anew, with what is new. */
    hand->streams = hand->streams && ahead_s >= 0.0;
    if (!hand->streams && hand->waiting > newest)
        asp_xr_forget(hand, hand->waiting - newest, &hand->dropped);
    if (hand->streams && ahead_s > 0.15)
        asp_xr_forget(hand, hand->waiting, &hand->dropped);
    if (hand->waiting == 0)
        return XR_SUCCESS;
    asp_xr_piece piece;
    memset(&piece, 0, sizeof piece);
    if (!hand->streams)
        lead = (uint32_t)(0.02 * hand->to_hz), hand->began_s = now_s, hand->sent = 0;
    piece.type = ASP_XR_TYPE_PCM_VIBRATION;
    piece.count = lead + hand->waiting, piece.samples = hand->samples + ASP_XR_LEAD - lead;
    piece.rate_hz = (float)hand->to_hz;
    piece.append = hand->streams ? XR_TRUE : XR_FALSE, piece.consumed = &consumed;
    hand->streams = 1;
    uint32_t count = hand->waiting;
    if (asp_xr_send(hand, &piece, count) == XR_SUCCESS) {
        consumed = consumed < piece.count ? consumed : piece.count;
        hand->sent += consumed, count = consumed > lead ? consumed - lead : 0;
        hand->played -= hand->waiting - count;
    }
    asp_xr_forget(hand, count, &counted);
    return hand->last;
}

/* Hands over what has come since the last call; `now_s` is any clock that only rises. The runtime's last answer. */
static inline XrResult asp_xr_tick(asp_xr_hand *hand, double now_s) {
    asp_point points[ASP_XR_AT_ONCE];
    XrResult result = XR_SUCCESS;
    uint64_t lost = asp_port_lost(hand->port) - hand->lost_before;
    if (hand->way == ASP_XR_PCM)
        return hand->to_hz > 0.0 ? asp_xr_wave(hand, now_s, lost) : result;
    hand->lost_before += lost, hand->dropped += lost;
    for (;;) {
        uint32_t count = asp_port_points(hand->port, points, ASP_XR_AT_ONCE);
        if (count == 0)
            return result;
        result = hand->way == ASP_XR_PARAMETRIC ? asp_xr_stream(hand, points, count, now_s) : asp_xr_once(hand, points, count);
    }
}

/* Ends what is felt at once. */
static inline XrResult asp_xr_stop(asp_xr_hand *hand) {
    hand->streams = 0, hand->dropped += hand->waiting, hand->waiting = 0;
    return hand->stop(hand->session, &hand->info);
}

#ifdef __cplusplus
}
#endif
#endif
