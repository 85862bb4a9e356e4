/* replay SCENE.toml LOG.jsonl TAIL_S OUT.f32 BLOCK [PICKUP.f32]: replays a log through the structs of the header, in blocks, and writes raw
 * samples: all haptic channels, then all buses, each the frames of `asperity render`; and what the pickups read. */
#include "common.h"

#include <math.h>

int main(int count, char **words) {
    MUST((count == 6 || count == 7) && asp_check() == ASP_OK);
    asp_config config;
    asp_config_init(&config);
    config.clock = ASP_CLOCK_EXACT;
    asp_scene *scene;
    asp_renderer *renderer;
    MUST(asp_load(words[1], NULL, NULL, &config, &scene, &renderer) == ASP_OK);
    uint32_t haptics, buses, pickups, latency, events_count;
    double rate_hz;
    MUST(asp_signals(renderer, &haptics, &buses, &rate_hz, &latency) == ASP_OK);
    MUST(asp_pickup_channels(renderer, &pickups) == ASP_OK);

    char *log = slurp(words[2], NULL);
    MUST(asp_read_log(scene, log, NULL, NULL, 0, sizeof(asp_event), &events_count) == ASP_OK && events_count > 0);
    asp_event *events = calloc(events_count, sizeof *events);
    double *times_s = calloc(events_count, sizeof *times_s);
    MUST(asp_read_log(scene, log, events, times_s, events_count, sizeof *events, &events_count) == ASP_OK);
    free(log);

    uint32_t frames = (uint32_t)ceil((times_s[events_count - 1] + atof(words[3])) * rate_hz), total = frames + latency;
    uint32_t signals = haptics + buses + pickups, block = (uint32_t)atoi(words[5]), done = 0, next = 0;
    float *samples = calloc((size_t)signals * total, sizeof *samples);
    MUST(signals <= 64 && block > 0);
    while (done < total) {
        uint32_t n = total - done < block ? total - done : block;
        /* All that may begin within this block is told before it, as a game does that runs ahead by one. */
        for (; next < events_count && times_s[next] * rate_hz < done + n + 1.0; next++)
            MUST(asp_report(scene, times_s[next], &events[next], 1, sizeof *events, NULL) == ASP_OK);
        float *planes[64];
        for (uint32_t i = 0; i < signals; i++)
            planes[i] = samples + (size_t)i * total + done;
        float **read = planes + haptics + buses;
        asp_pickup_render(renderer, planes, haptics, planes + haptics, buses, read, pickups, n);
        done += n;
    }
    for (int file = 4; file < count; file += 2) {
        FILE *out = fopen(words[file], "wb");
        MUST(out);
        uint32_t first = file == 4 ? 0 : haptics + buses, end = file == 4 ? haptics + buses : signals;
        for (uint32_t i = first; i < end; i++)
            MUST(fwrite(samples + (size_t)i * total + latency, sizeof *samples, frames, out) == frames);
        MUST(fclose(out) == 0);
    }
    asp_stats stats;
    asp_stats_init(&stats);
    MUST(asp_get_stats(scene, &stats) == ASP_OK && stats.refused == 0 && stats.dropped == 0);
    MUST(asp_renderer_free(renderer) == ASP_OK && asp_scene_free(scene) == ASP_OK);
    free(samples), free(events), free(times_s);
    return 0;
}
