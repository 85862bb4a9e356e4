/* asperity_render: a scene in, signals out, for MATLAB and Octave.
 *
 *   [audio, haptic, rate_hz] = asperity_render('scene.toml', fileread('stroke.jsonl'), tail_s)
 *
 * audio has a column a bus, haptic a column an actuator. Build: mkoctfile --mex asperity_render.c -lasperity, or mex asperity_render.c
 * -lasperity. */
#include <asperity.h>
#include <mex.h>

#include <math.h>
#include <stdio.h>

static asp_scene *scene;
static asp_renderer *renderer;

/* Ends the call with the library's sentence; what is open is freed first. */
static void need(int32_t status) {
    if (status == ASP_OK)
        return;
    char sentence[1024];
    snprintf(sentence, sizeof sentence, "%s", asp_last_error());
    asp_scene_free(scene), asp_renderer_free(renderer);
    scene = NULL, renderer = NULL;
    mexErrMsgIdAndTxt("asperity:refused", "%s", sentence);
}

static char *text(const mxArray *value, const char *name) {
    char *words = mxIsChar(value) ? mxArrayToString(value) : NULL;
    if (!words)
        mexErrMsgIdAndTxt("asperity:usage", "%s: is no text; give a row of characters", name);
    return words;
}

/* Planar samples as the columns of a matrix. */
static mxArray *columns(const float *first, size_t total, size_t skip, size_t frames, size_t count) {
    mxArray *matrix = mxCreateDoubleMatrix(frames, count, mxREAL);
    double *to = mxGetPr(matrix);
    for (size_t c = 0; c < count; c++)
        for (size_t i = 0; i < frames; i++)
            *to++ = first[c * total + skip + i];
    return matrix;
}

void mexFunction(int left_count, mxArray *left[], int count, const mxArray *words[]) {
    if (count < 2 || count > 3 || left_count > 3)
        mexErrMsgIdAndTxt("asperity:usage", "call [audio, haptic, rate_hz] = asperity_render(scene, log, tail_s); log is the text of a contact log");
    char *path = text(words[0], "scene"), *log = text(words[1], "log");
    double tail_s = count == 3 ? mxGetScalar(words[2]) : 1.0;
    if (!(tail_s >= 0 && tail_s <= 3600))
        mexErrMsgIdAndTxt("asperity:usage", "tail_s: %g is refused; must be 0 to 3600 s", tail_s);
    asp_config config;
    asp_config_init(&config);
    config.clock = ASP_CLOCK_EXACT;
    need(asp_check());
    need(asp_load(path, NULL, NULL, &config, &scene, &renderer));

    uint32_t haptics, buses, latency, events;
    double rate_hz;
    need(asp_signals(renderer, &haptics, &buses, &rate_hz, &latency));
    need(asp_read_log(scene, log, NULL, NULL, 0, sizeof(asp_event), &events));
    asp_event *event = mxCalloc(events + 1, sizeof *event);
    double *time_s = mxCalloc(events + 1, sizeof *time_s);
    need(asp_read_log(scene, log, event, time_s, events, sizeof *event, &events));
    size_t frames = (size_t)ceil(((events ? time_s[events - 1] : 0.0) + tail_s) * rate_hz), total = frames + latency;
    float *samples = mxCalloc((haptics + buses) * total + 1, sizeof *samples);
    uint32_t next = 0;
    for (size_t done = 0, n; done < total; done += n) {
        n = total - done < 256 ? total - done : 256;
        for (; next < events && time_s[next] * rate_hz < (double)(done + n) + 1.0; next++)
            need(asp_report(scene, time_s[next], &event[next], 1, sizeof *event, NULL));
        float *planes[2 * ASP_MAX_CHANNELS];
        for (size_t c = 0; c < haptics + buses; c++)
            planes[c] = samples + c * total + done;
        asp_render(renderer, planes, haptics, planes + haptics, buses, (uint32_t)n);
    }
    left[0] = columns(samples + haptics * total, total, latency, frames, buses);
    if (left_count > 1)
        left[1] = columns(samples, total, latency, frames, haptics);
    if (left_count > 2)
        left[2] = mxCreateDoubleScalar(rate_hz);
    asp_scene_free(scene), asp_renderer_free(renderer);
    scene = NULL, renderer = NULL;
    mxFree(path), mxFree(log), mxFree(event), mxFree(time_s), mxFree(samples);
}
