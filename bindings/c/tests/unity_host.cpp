// A host that replays what a mixer does to a native effect: load, create, set the parameter, process, release. The structs are those of the
// plug-in interface 1.4, with the offsets of a 64-bit build as numbers.
#include <dlfcn.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include <asperity.h>

#define MUST(holds)                                                                                                    \
    do {                                                                                                               \
        if (!(holds)) {                                                                                                \
            std::fprintf(stderr, "%s:%d: %s does not hold\n", __FILE__, __LINE__, #holds);                             \
            std::exit(1);                                                                                              \
        }                                                                                                              \
    } while (0)

struct State {
    std::uint32_t structsize, samplerate;
    std::uint64_t currdsptick, prevdsptick;
    float *sidechainbuffer;
    void *effectdata;
    std::uint32_t flags;
    void *internal, *spatializerdata;
    std::uint32_t dspbuffersize, hostapiversion;
    void *ambisonicdata;
};
struct Parameter {
    char name[16], unit[16];
    const char *description;
    float min, max, defaultval, displayscale, displayexponent;
};
struct Definition {
    std::uint32_t structsize, paramstructsize, apiversion, pluginversion, channels, numparameters;
    std::uint64_t flags;
    char name[32];
    int (*create)(State *);
    int (*release)(State *);
    int (*reset)(State *);
    int (*process)(State *, float *, float *, unsigned, int, int);
    int (*setposition)(State *, unsigned);
    Parameter *paramdefs;
    int (*setfloatparameter)(State *, int, float);
    int (*getfloatparameter)(State *, int, float *, char *);
    int (*getfloatbuffer)(State *, const char *, float *, int);
};
static_assert(sizeof(State) == 80 && sizeof(Definition) == 136 && sizeof(Parameter) == 64, "a 64-bit build");
static_assert(offsetof(State, effectdata) == 32 && offsetof(State, flags) == 40 && offsetof(Definition, process) == 88 &&
                  offsetof(Definition, paramdefs) == 104,
              "a 64-bit build");

int main(int count, char **words) {
    MUST(count == 2);
    void *library = dlopen(words[1], RTLD_NOW);
    MUST(library);
    auto definitions = reinterpret_cast<int (*)(Definition ***)>(dlsym(library, "UnityGetAudioEffectDefinitions"));
    Definition **list = nullptr;
    MUST(definitions && definitions(&list) == 1);
    Definition &effect = **list;
    MUST(effect.structsize == 136 && effect.paramstructsize == 64 && !std::strcmp(effect.name, "Asperity") && effect.numparameters == 1);
    MUST(effect.apiversion == 0x010402 && !std::strcmp(effect.paramdefs[0].name, "Engine") && effect.paramdefs[0].max <= 16777216.0f);
    Definition **again = nullptr;
    MUST(definitions(&again) == 1 && *again == &effect);

    // The game's side, in the same library.
#define NATIVE(name) auto name##_ = reinterpret_cast<decltype(&name)>(dlsym(library, #name))
    NATIVE(asp_config_init);
    NATIVE(asp_build);
    NATIVE(asp_body_init);
    NATIVE(asp_add_body);
    NATIVE(asp_event_init);
    NATIVE(asp_report);
    NATIVE(asp_unity_slot);
    NATIVE(asp_renderer_free);
    NATIVE(asp_scene_free);
    NATIVE(asp_get_stats);
    NATIVE(asp_stats_init);
    asp_config config;
    asp_config_init_(&config);
    config.sample_rate_hz = 48000;
    asp_scene *scene;
    asp_renderer *renderer;
    MUST(asp_build_(&config, &scene, &renderer) == ASP_OK);
    asp_body body;
    asp_body_init_(&body);
    body.stock = "bar", body.size_m = 0.2;
    std::uint64_t bar;
    MUST(asp_add_body_(scene, &body, &bar) == ASP_OK);
    std::uint32_t slot;
    MUST(asp_unity_slot_(renderer, &slot) == ASP_OK && slot > 0 && slot <= effect.paramdefs[0].max);

    State state{}, second{};
    state.structsize = second.structsize = sizeof(State), state.samplerate = second.samplerate = 48000;
    state.hostapiversion = second.hostapiversion = 0x010402, state.dspbuffersize = second.dspbuffersize = 1024;
    MUST(effect.create(&state) == 0 && effect.create(&second) == 0 && state.effectdata && effect.reset(&state) == 0);
    float value = -1.0f;
    char text[64] = "x";
    MUST(effect.setfloatparameter(&state, 0, static_cast<float>(slot)) == 0 && effect.getfloatparameter(&state, 0, &value, text) == 0);
    MUST(value == static_cast<float>(slot) && text[0] == 0 && effect.setfloatparameter(&second, 0, static_cast<float>(slot)) == 0);
    MUST(effect.setfloatparameter(&state, 7, 1.0f) != 0 && effect.getfloatbuffer(&state, "x", &value, 1) != 0);

    asp_stats stats;
    asp_stats_init_(&stats);
    double peak = 0.0;
    std::vector<float> in(2 * 1024), out(2 * 1024), other(2 * 1024);
    for (int block = 0; block < 60; block++) {
        for (std::size_t i = 0; i < in.size(); i++)
            in[i] = 0.01f * static_cast<float>(i % 7);
        state.prevdsptick = state.currdsptick, state.currdsptick += 1024, second.currdsptick = state.currdsptick;
        const bool plays = block >= 10;
        state.flags = second.flags = plays ? 1u : 0u; // in edit mode nothing plays
        if (block == 12) {
            asp_event event;
            asp_event_init_(&event);
            event.kind = ASP_IMPACT, event.body = bar;
            MUST(asp_report_(scene, 0.25, &event, 1, sizeof event, nullptr) == ASP_OK);
        }
        MUST(effect.process(&state, in.data(), out.data(), 1024, 2, 2) == 0);
        // A second effect with the same engine in the same block lets the signal through and takes no time from the engine.
        MUST(effect.process(&second, in.data(), other.data(), 1024, 2, 2) == 0 && other == in);
        for (std::size_t i = 0; i < in.size(); i++)
            peak = std::fmax(peak, std::fabs(static_cast<double>(out[i]) - static_cast<double>(in[i])));
        if (!plays)
            MUST(out == in);
        MUST(asp_get_stats_(scene, &stats) == ASP_OK && stats.position == (plays ? 1024u * static_cast<unsigned>(block - 9) : 0u));
    }
    MUST(peak > 1e-4);
    state.flags = 1 | 2; // the editor's pause
    MUST(effect.process(&state, in.data(), out.data(), 1024, 2, 2) == 0 && out == in);
    // Six channels, one channel, no input; an engine that is gone; numbers that are none.
    std::vector<float> wide(6 * 1024, 9.0f);
    state.flags = 1, state.currdsptick += 1024;
    MUST(effect.process(&state, nullptr, wide.data(), 1024, 0, 6) == 0 && wide[2] == 0.0f);
    state.currdsptick += 1024;
    MUST(effect.process(&state, in.data(), wide.data(), 1024, 2, 1) == 0);
    for (float odd : {-5.0f, 1e9f, 4294967296.0f, NAN, INFINITY, 1024.0f}) {
        MUST(effect.setfloatparameter(&state, 0, odd) == 0);
        state.currdsptick += 1024;
        MUST(effect.process(&state, in.data(), out.data(), 1024, 2, 2) == 0 && out == in);
    }
    MUST(effect.setfloatparameter(&state, 0, static_cast<float>(slot)) == 0 && asp_renderer_free_(renderer) == ASP_OK);
    state.currdsptick += 1024;
    MUST(effect.process(&state, in.data(), out.data(), 1024, 2, 2) == 0 && out == in);
    MUST(effect.release(&state) == 0 && effect.release(&second) == 0 && !state.effectdata && asp_scene_free_(scene) == ASP_OK);
    MUST(effect.process(&state, in.data(), out.data(), 1024, 2, 2) == 0);
    std::printf("Unity host: sound in the group (peak %.3g), silent in edit mode, no pointer in a float\n", peak);
    return 0;
}
