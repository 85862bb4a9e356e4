// The component of the page, as Unreal drives it: 60 ticks a second, each with its audio.
#include "unreal_types.hpp"

#include "TouchSynth.h"

#include <cstdlib>

#define MUST(holds) ((holds) ? (void)0 : (std::fprintf(stderr, "%s does not hold\n", #holds), std::exit(1)))

int main() {
    UWorld world;
    UTouchSynth synth;
    synth.World = &world;
    MUST(synth.Starts(48000));
    std::uint64_t body = 0, surface = 0;
    MUST(synth.AddPlate("plate", 0.14, ASP_MATERIAL_CERAMIC, "solid = \"granite\"", 0.14, body, surface));
    float stroked = 0, struck = 0, felt = 0, out[2 * 800];
    int counted = 0;
    for (int tick = 0; tick < 120; tick++, world.Seconds += 1.0 / 60.0) {
        if (tick < 60)
            synth.Touch(7, surface, {0.2 + 0.005 * tick, 0.5}, 0.6, 0);
        if (tick == 60)
            synth.Lift(7), synth.Lift(7);
        if (tick == 90)
            synth.Strike(body, {0, 0, 0.2}, 50);
        MUST(synth.Generates(out, 2 * 800) == 2 * 800);
        for (int i = 0; i < 800; i++) {
            float &peak = tick < 60 ? stroked : struck;
            peak = std::fmax(peak, std::fabs(out[2 * i]));
            MUST(out[2 * i] == out[2 * i + 1]);
        }
        auto samples = synth.Felt();
        counted += samples.Num();
        for (int32 i = 0; i < samples.Num(); i++)
            felt = std::fmax(felt, std::fabs(samples.GetData()[i]));
    }
    MUST(stroked > 1e-5f && struck > 1e-4f && felt > 1e-5f && counted == 120 * 800 && warnings == 0);
    MUST(!synth.AddPlate("cube", 1, ASP_MATERIAL_STEEL, nullptr, 1, body, surface) && warnings == 1);
    std::printf("Unreal's page: a stroke is heard (%.3g) and felt (%.3g), a blow rings (%.3g)\n", stroked, felt, struck);
    return 0;
}
