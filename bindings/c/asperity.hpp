// asperity for C++17: the C interface with destructors, header-only, without exceptions unless ASP_EXCEPTIONS is defined before it is
// included. Every call gives asp::Status, which knows the engine's sentence.
#ifndef ASPERITY_HPP
#define ASPERITY_HPP

#include "asperity.h"

#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>
#ifdef ASP_EXCEPTIONS
#include <stdexcept>
#endif

namespace asp {

// What a call has answered; `text` is empty when all is well.
class [[nodiscard]] Status {
public:
    Status() = default;
    explicit Status(std::int32_t code) : code_(code) {
        if (code != ASP_OK) {
            text_ = asp_last_error();
#ifdef ASP_EXCEPTIONS
            throw std::runtime_error(text_);
#endif
        }
    }
    explicit operator bool() const { return code_ == ASP_OK; }
    std::int32_t code() const { return code_; }
    const std::string &text() const { return text_; }

private:
    std::int32_t code_ = ASP_OK;
    std::string text_;
};

// Whether header and library belong together: call it once, first.
inline Status check() { return Status(asp_check()); }

// Structs with their sizes and defaults.
inline asp_config config() {
    asp_config made;
    asp_config_init(&made);
    return made;
}
inline asp_body body() {
    asp_body made;
    asp_body_init(&made);
    return made;
}
inline asp_surface surface(double width_m, double height_m) {
    asp_surface made;
    asp_surface_init(&made);
    made.width_m = width_m;
    made.height_m = height_m;
    return made;
}
inline asp_port_config port_config(std::uint32_t kind) {
    asp_port_config made;
    asp_port_config_init(&made);
    made.kind = kind;
    return made;
}

namespace detail {
// A handle that frees what it names.
template <typename Raw, std::int32_t (*Free)(Raw *)> class Handle {
public:
    Handle() = default;
    explicit Handle(Raw *raw) : raw_(raw) {}
    Handle(Handle &&other) noexcept : raw_(std::exchange(other.raw_, nullptr)) {}
    Handle &operator=(Handle &&other) noexcept {
        if (this != &other) {
            Free(raw_);
            raw_ = std::exchange(other.raw_, nullptr);
        }
        return *this;
    }
    Handle(const Handle &) = delete;
    Handle &operator=(const Handle &) = delete;
    ~Handle() { Free(raw_); }
    Raw *get() const { return raw_; }
    Raw *release() { return std::exchange(raw_, nullptr); }
    explicit operator bool() const { return raw_ != nullptr; }

private:
    Raw *raw_ = nullptr;
};
} // namespace detail

// The audio thread's half. Nothing in `render` fails, allocates, locks or waits.
class Renderer : public detail::Handle<asp_renderer, asp_renderer_free> {
public:
    using Handle::Handle;
    void render(float *const *haptic, std::uint32_t channels, float *const *audio, std::uint32_t buses, std::uint32_t frames) {
        asp_render(get(), haptic, channels, audio, buses, frames);
    }
    void render_interleaved(float *out, std::uint32_t channels, std::uint32_t frames, const std::int32_t *map = nullptr) {
        asp_render_interleaved(get(), out, channels, frames, map);
    }
    std::uint32_t latency_samples() const {
        std::uint32_t samples = 0;
        asp_signals(get(), nullptr, nullptr, nullptr, &samples);
        return samples;
    }
    double sample_rate_hz() const {
        double rate_hz = 0.0;
        asp_signals(get(), nullptr, nullptr, &rate_hz, nullptr);
        return rate_hz;
    }
};

// The reading end of a port.
class Port : public detail::Handle<asp_port, asp_port_free> {
public:
    using Handle::Handle;
    std::uint32_t pcm(float *samples, std::uint32_t count) { return asp_port_pcm(get(), samples, count); }
    std::uint32_t points(asp_point *points, std::uint32_t count) { return asp_port_points(get(), points, count); }
    std::uint32_t forces(asp_force *forces, std::uint32_t count) { return asp_port_forces(get(), forces, count); }
    std::pair<double, double> levels() {
        double heavy = 0.0, light = 0.0;
        asp_port_levels(get(), &heavy, &light);
        return {heavy, light};
    }
    std::uint64_t lost() const { return asp_port_lost(get()); }
};

// A tracked tip: the pose of a fingertip becomes an event that the scene takes.
class Tip : public detail::Handle<asp_tip, asp_tip_free> {
public:
    using Handle::Handle;
    // At `position_m` (x, y, z), `dt_s` after the last step; `event.kind` is 0 where nothing is touched.
    Status step(double dt_s, const double *position_m, std::uint64_t contact, std::int32_t actuator, asp_event &event) {
        return Status(asp_tip_step(get(), dt_s, position_m, contact, actuator, &event));
    }
    // The game has moved the hand elsewhere: ends what it touches.
    Status lift(std::uint64_t contact, asp_event &event) { return Status(asp_tip_lift(get(), contact, &event)); }
};

// The game's half.
class Scene : public detail::Handle<asp_scene, asp_scene_free> {
public:
    using Handle::Handle;
    Status add(const asp_body &body, std::uint64_t &id) { return Status(asp_add_body(get(), &body, &id)); }
    Status add(const asp_surface &surface, std::uint64_t &id) { return Status(asp_add_surface(get(), &surface, &id)); }
    Status replace_body(std::uint64_t id, const asp_body &body) { return Status(asp_replace_body(get(), id, &body)); }
    Status replace_surface(std::uint64_t id, const asp_surface &surface) {
        return Status(asp_replace_surface(get(), id, &surface));
    }
    Status remove_body(std::uint64_t id) { return Status(asp_remove_body(get(), id)); }
    Status remove_surface(std::uint64_t id) { return Status(asp_remove_surface(get(), id)); }
    Status add_probe(const char *table, std::uint64_t &id, const char *name = nullptr) {
        return Status(asp_add_probe(get(), table, name, &id));
    }
    Status find(std::uint32_t kind, const char *name, std::uint64_t &id) const {
        return Status(asp_find(get(), kind, name, &id));
    }
    Status report(double time_s, const asp_event *events, std::size_t count, std::uint32_t *taken = nullptr) {
        return Status(asp_report(get(), time_s, events, static_cast<std::uint32_t>(count), sizeof(asp_event), taken));
    }
    Status report(double time_s, const asp_event &event) { return report(time_s, &event, 1); }
    Status report(double time_s, const std::vector<asp_event> &events) {
        return report(time_s, events.data(), events.size());
    }
    Status open(const asp_port_config &config, Port &port) {
        asp_port *raw = nullptr;
        Status status(asp_open_port(get(), &config, &raw));
        port = Port(raw);
        return status;
    }
    // A tracked tip over surfaces that have a frame; NAN = the usual coupling.
    Status track(const std::vector<std::uint64_t> &surfaces, Tip &tip, double stiffness_n_m = NAN, double mass_kg = NAN,
                 double max_force_n = NAN) {
        asp_tip *raw = nullptr;
        auto count = static_cast<std::uint32_t>(surfaces.size());
        Status status(asp_tip_new(get(), surfaces.data(), count, stiffness_n_m, mass_kg, max_force_n, &raw));
        tip = Tip(raw);
        return status;
    }
    // A level in use, ASP_LEVEL_…: of a haptic channel, a bus, or the id of a body.
    Status level(std::uint32_t kind, std::uint64_t of, double &level) const {
        return Status(asp_get_level(get(), kind, of, &level));
    }
    Status stats(asp_stats &stats) const {
        asp_stats_init(&stats);
        return Status(asp_get_stats(get(), &stats));
    }
    std::string why_silent() const { return why(asp_why_silent); }
    std::string why_clipped() const { return why(asp_why_clipped); }

private:
    std::string why(std::int32_t (*told)(asp_scene *, char *, std::uint32_t)) const {
        std::string words(4096, '\0');
        told(get(), words.data(), static_cast<std::uint32_t>(words.size()));
        words.resize(words.find('\0'));
        return words;
    }
};

// Both halves of an engine.
struct Engine {
    Scene scene;
    Renderer renderer;
};

inline Status build(const asp_config &config, Engine &engine) {
    asp_scene *scene = nullptr;
    asp_renderer *renderer = nullptr;
    Status status(asp_build(&config, &scene, &renderer));
    engine.scene = Scene(scene);
    engine.renderer = Renderer(renderer);
    return status;
}

// The engine of a scene file.
inline Status load(const char *path, const asp_config &config, Engine &engine, const asp_files *files = nullptr,
                   const char *text = nullptr) {
    asp_scene *scene = nullptr;
    asp_renderer *renderer = nullptr;
    Status status(asp_load(path, text, files, &config, &scene, &renderer));
    engine.scene = Scene(scene);
    engine.renderer = Renderer(renderer);
    return status;
}

} // namespace asp

#endif
