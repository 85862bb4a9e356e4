// In C++17: a plate is struck and stroked for half a second; what comes out is measured.
#include <asperity.hpp>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

static void need(const asp::Status &status) {
    if (!status) {
        std::fprintf(stderr, "error: %s\n", status.text().c_str());
        std::exit(1);
    }
}

int main() {
    need(asp::check());
    asp_config config = asp::config();
    config.sample_rate_hz = 48000.0;
    config.clock = ASP_CLOCK_EXACT;
    config.more = "audio = [{ gain = 0.2, limit = true }]";
    asp::Engine engine;
    need(asp::build(config, engine));

    std::uint64_t plate = 0, top = 0;
    asp_body body = asp::body();
    body.stock = "plate";
    body.size_m = 0.14;
    body.material = ASP_MATERIAL_GLASS;
    need(engine.scene.add(body, plate));
    asp_surface surface = asp::surface(0.14, 0.14);
    surface.body = plate;
    surface.table = "solid = \"granite\"";
    need(engine.scene.add(surface, top));
    asp::Port rumble;
    asp_port_config wanted = asp::port_config(ASP_PORT_LEVELS);
    wanted.rate_hz = 30.0;
    need(engine.scene.open(wanted, rumble));

    double heard = 0.0, felt = 0.0;
    std::vector<float> haptic(800), audio(800);
    for (int tick = 0; tick < 30; tick++) {
        const double time_s = tick / 60.0, u = 0.1 + time_s;
        need(engine.scene.report(time_s, tick == 0 ? asp_begin(1, top, 0, u, 0.5, 0.6) : asp_move(1, u, 0.5, 0.6)));
        if (tick == 3)
            need(engine.scene.report(time_s, asp_collision(plate, 0.002, 0.5, 0.6)));
        float *channels[] = {haptic.data()}, *buses[] = {audio.data()};
        engine.renderer.render(channels, 1, buses, 1, 800);
        for (int i = 0; i < 800; i++) {
            heard = std::fmax(heard, std::fabs(static_cast<double>(audio[i])));
            felt = std::fmax(felt, std::fabs(static_cast<double>(haptic[i])));
        }
    }
    const auto [heavy, light] = rumble.levels();
    std::printf("heard %.3g, felt %.3g, motors %.3g and %.3g. %s\n", heard, felt, heavy, light, engine.scene.why_silent().c_str());
    asp_surface nowhere = asp::surface(-1.0, 0.1);
    const asp::Status refused = engine.scene.add(nowhere, top);
    std::printf("refused: %s\n", refused.text().c_str());
    return heard > 0.0 && felt > 0.0 && heavy + light > 0.0 && !refused ? 0 : 1;
}
