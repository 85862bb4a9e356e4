/* A runtime that judges each haptic call by the rules of its extension: what headset.c plays to. */
/* The runtime. */
static struct {
    int focused, way;
    uint64_t session;
    XrDuration first_frame_ns;
    double now_s;
    int streams;
    double began_s;
    XrDuration amplitude_ns, frequency_ns;
    uint64_t calls, frames, points, firsts, lasts, broken, plain, stops;
    const char *rule;
    double played_amplitude, first_call_s;
    /* A waveform: what waits, its room, and all that was taken; how often it ran dry. */
    double waits, room;
    uint64_t taken, begun;
    float wave[200000];
} runtime;

static XrResult broken(const char *rule) {
    runtime.broken++;
    runtime.rule = rule;
    return XR_ERROR_VALIDATION_FAILURE;
}

static int ordered(const asp_xr_value *values, uint32_t count, XrDuration from) {
    for (uint32_t at = 0; at < count; from = values[at++].time) {
        if (values[at].time < from || !(values[at].value >= 0.0f && values[at].value <= 1.0f))
            return 0;
    }
    return 1;
}

static XrResult judge(const asp_xr_vibration *frame) {
    int type = frame->stream_frame_type, begins = type == ASP_XR_WHOLE || type == ASP_XR_FIRST;
    uint32_t levels = frame->amplitude_count, tones = frame->frequency_count;
    float low = frame->min_frequency_hz, high = frame->max_frequency_hz;
    /* A stream is over 50 ms after its last point. */
    if (runtime.streams && (runtime.now_s - runtime.began_s) * 1e9 > (double)(runtime.amplitude_ns + ASP_XR_HELD_NS))
        runtime.streams = 0;
    if (type < 0 || type > 3)
        return broken("an unknown kind of frame");
    if (levels < (begins ? 2u : 1u))
        return broken("too few amplitude points");
    if (levels > ASP_XR_MOST_POINTS || tones > ASP_XR_MOST_POINTS || frame->transient_count > ASP_XR_MOST_POINTS)
        return broken("too many points");
    if (begins && (frame->amplitudes[0].time != 0 || (tones > 0 && frame->frequencies[0].time != 0)))
        return broken("the first point is not at 0");
    if (!begins && !runtime.streams)
        return broken("no stream is running");
    if (type == ASP_XR_FIRST && frame->amplitudes[levels - 1].time < runtime.first_frame_ns)
        return broken("the first frame is too short");
    if (!ordered(frame->amplitudes, levels, begins ? 0 : runtime.amplitude_ns) ||
        !ordered(frame->frequencies, tones, begins ? 0 : runtime.frequency_ns))
        return broken("times fall, or a value is outside 0 to 1");
    if (!begins && (low != 0.0f || high != 0.0f))
        return broken("a later frame says its frequencies");
    if ((low == 0.0f) != (high == 0.0f) || (low != 0.0f && (low < 1.0f || high > 1000.0f || high < low)))
        return broken("frequencies outside 1 to 1000 Hz");
    runtime.amplitude_ns = frame->amplitudes[levels - 1].time;
    runtime.frequency_ns = tones > 0 ? frame->frequencies[tones - 1].time : begins ? 0 : runtime.frequency_ns;
    if ((type == ASP_XR_WHOLE || type == ASP_XR_LAST) && runtime.frequency_ns > runtime.amplitude_ns)
        return broken("a frequency behind the last amplitude");
    if (begins)
        runtime.began_s = runtime.now_s, runtime.firsts++;
    runtime.lasts += type == ASP_XR_LAST;
    runtime.streams = type == ASP_XR_FIRST || type == ASP_XR_INTERMEDIATE;
    runtime.frames++, runtime.points += levels;
    for (uint32_t at = 0; at < levels; at++)
        runtime.played_amplitude = fmax(runtime.played_amplitude, frame->amplitudes[at].value);
    return XR_SUCCESS;
}

#define PCM_HZ 2000.0

/* Samples leave in time; it takes what it has room for, which is little now and then. */
static XrResult judge_piece(const asp_xr_piece *piece) {
    if (piece->count == 0 || piece->count > 4000 || !piece->samples || !piece->consumed)
        return broken("a piece without samples, of too many, or without room for the answer");
    if (piece->rate_hz != (float)PCM_HZ || (piece->append != XR_TRUE && piece->append != XR_FALSE))
        return broken("another rate than the controller's");
    for (uint32_t at = 0; at < piece->count; at++)
        if (!(piece->samples[at] >= -1.0f && piece->samples[at] <= 1.0f))
            return broken("a sample outside -1 to 1");
    runtime.waits = fmax(0.0, runtime.waits - (runtime.now_s - runtime.began_s) * PCM_HZ);
    runtime.began_s = runtime.now_s;
    if (!piece->append)
        runtime.waits = 0.0, runtime.begun++;
    *piece->consumed = (uint32_t)fmin(piece->count, fmax(0.0, runtime.room - runtime.waits));
    for (uint32_t at = 0; at < *piece->consumed; at++)
        if (runtime.taken < sizeof runtime.wave / sizeof *runtime.wave)
            runtime.wave[runtime.taken++] = piece->samples[at];
    runtime.waits += *piece->consumed, runtime.plain++;
    return XR_SUCCESS;
}

static XrResult judge_levels(const asp_xr_levels *levels) {
    if (levels->count == 0 || levels->count > 4000 || levels->duration <= 0 || levels->duration > 200000000)
        return broken("an envelope of no length, or of too many levels");
    for (uint32_t at = 0; at < levels->count; at++) {
        if (!(levels->amplitudes[at] >= 0.0f && levels->amplitudes[at] <= 1.0f))
            return broken("a level outside 0 to 1");
        runtime.played_amplitude = fmax(runtime.played_amplitude, levels->amplitudes[at]);
    }
    runtime.plain++;
    return XR_SUCCESS;
}

/* The judge itself: what the extension's conformance tests refuse. */
static void judges(void) {
    asp_xr_value two[2] = {{0, 0.5f}, {60000000, 0.5f}}, wild[2] = {{0, 0.5f}, {60000000, 1.1f}}, back[2] = {{0, 0.5f}, {10000000, 0.5f}};
    asp_xr_vibration frame;
    memset(&runtime, 0, sizeof runtime), memset(&frame, 0, sizeof frame);
    runtime.first_frame_ns = 50000000;
    frame.type = ASP_XR_TYPE_PARAMETRIC_VIBRATION, frame.amplitudes = two;
    frame.amplitude_count = 2, frame.stream_frame_type = ASP_XR_INTERMEDIATE;
    MUST(judge(&frame) < 0); /* no stream */
    frame.stream_frame_type = ASP_XR_FIRST, frame.amplitude_count = 1;
    MUST(judge(&frame) < 0);
    frame.amplitude_count = 2, frame.amplitudes = wild;
    MUST(judge(&frame) < 0);
    frame.amplitudes = back;
    MUST(judge(&frame) < 0); /* too short */
    frame.amplitudes = two, frame.min_frequency_hz = 55.0f;
    MUST(judge(&frame) < 0); /* one frequency alone */
    frame.max_frequency_hz = 200.0f;
    MUST(judge(&frame) == XR_SUCCESS);
    frame.stream_frame_type = ASP_XR_INTERMEDIATE, two[0].time = 60000000, two[1].time = 70000000;
    MUST(judge(&frame) < 0); /* frequencies again */
    frame.min_frequency_hz = frame.max_frequency_hz = 0.0f, frame.amplitudes = back;
    MUST(judge(&frame) < 0); /* times fall */
    frame.amplitudes = two;
    MUST(judge(&frame) == XR_SUCCESS);
    runtime.now_s = 1.0;
    MUST(judge(&frame) < 0); /* the stream ran dry */
}

XrResult XRAPI_CALL judged_apply(XrSession session, const XrHapticActionInfo *info, const XrHapticBaseHeader *haptic);
XrResult XRAPI_CALL judged_stop(XrSession session, const XrHapticActionInfo *info);
uint64_t judged_session(void);

XrResult XRAPI_CALL judged_apply(XrSession session, const XrHapticActionInfo *info, const XrHapticBaseHeader *haptic) {
    runtime.calls++;
    if (session != (XrSession)(uintptr_t)runtime.session)
        return XR_ERROR_SESSION_LOST;
    if (info->type != XR_TYPE_HAPTIC_ACTION_INFO || info->action != (XrAction)(uintptr_t)7)
        return broken("another action");
    if (!runtime.focused) {
        runtime.streams = 0;
        return XR_SESSION_NOT_FOCUSED;
    }
    if (runtime.first_call_s < 0.0)
        runtime.first_call_s = runtime.now_s;
    if (haptic->type == ASP_XR_TYPE_PARAMETRIC_VIBRATION && runtime.way == ASP_XR_PARAMETRIC)
        return judge((const asp_xr_vibration *)haptic);
    if (haptic->type == ASP_XR_TYPE_PCM_VIBRATION && runtime.way == ASP_XR_PCM)
        return judge_piece((const asp_xr_piece *)haptic);
    if (haptic->type == ASP_XR_TYPE_ENVELOPE_VIBRATION && runtime.way == ASP_XR_ENVELOPE)
        return judge_levels((const asp_xr_levels *)haptic);
    const XrHapticVibration *plain = (const XrHapticVibration *)haptic;
    runtime.plain++;
    if (haptic->type != XR_TYPE_HAPTIC_VIBRATION || plain->duration <= 0 || !(plain->amplitude >= 0.0f && plain->amplitude <= 1.0f) ||
        !(plain->frequency >= 0.0f))
        return broken("a plain vibration out of range");
    return XR_SUCCESS;
}

XrResult XRAPI_CALL judged_stop(XrSession session, const XrHapticActionInfo *info) {
    (void)session, (void)info;
    runtime.streams = 0, runtime.stops++;
    return XR_SUCCESS;
}

/* Every session has another name; what is said to an older one is refused. */
uint64_t judged_session(void) {
    static uint64_t sessions;
    runtime.streams = 0;
    return runtime.session = ++sessions;
}
