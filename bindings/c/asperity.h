/*
 * asperity: touch into signal. Contact events in, haptic channels and audio out, in hard real time.
 *
 * Every function that can fail gives 0 or a negative status, and asp_last_error() says in a sentence which field is wrong, how,
 * and what would be right. Units are in the names: metres, newtons, seconds, hertz. Structs begin with their size: call
 * asp_..._init first. Ids are numbers that are never 0; 0 means none. A scene belongs to one thread at a time, a renderer to one (the
 * audio thread), a port to one; any of them may be freed while others live. Texts are UTF-8 and copied.
 *
 * The audio thread may call asp_render, asp_pickup_render, asp_render_interleaved, asp_report_load and the asp_port_... that read: they never fail,
 * allocate, lock or wait.
 */

#ifndef ASPERITY_H
#define ASPERITY_H

/* Written by bindings/c/header from the sources of the library: change those. */

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/// Most samples of a clip.
#define ASP_MAX_CLIP_SAMPLES (1 << 26)

/// Game seconds follow the device through pauses, restarts, slow motion and bursts of ticks: for a
/// game that runs now.
#define ASP_CLOCK_LIVE 0

/// Sample = seconds times rate: for renders and replays.
#define ASP_CLOCK_EXACT 1

/// As the text `more` says.
#define ASP_CLOCK_MORE 2

/// The fastest instruction set of this processor.
#define ASP_KERNEL_BEST 0

/// Kernel with equal bits on every processor.
#define ASP_KERNEL_PORTABLE 1

/// Most haptic channels of an engine that is built or loaded here.
#define ASP_MAX_CHANNELS 64

/// Most audio buses of an engine.
#define ASP_MAX_BUSES 64

/// A contact lands on a surface.
#define ASP_BEGIN 1

/// A contact goes on.
#define ASP_MOVE 2

/// A contact lifts off.
#define ASP_END 3

/// A rigid striker hits a body.
#define ASP_IMPACT 4

/// Samples are 0 to 255.
#define ASP_U8 0

/// Samples are 0 to 65535.
#define ASP_U16 1

/// Samples are floating point, taken as they are.
#define ASP_F32 2

/// Metres, or metres a second squared, at sample value 1.0 of a haptic channel; of: the channel.
#define ASP_LEVEL_FULL_SCALE 1

/// Linear gain of an audio bus; of: the bus.
#define ASP_LEVEL_BUS_GAIN 2

/// Linear gain of impacts beside strokes; of: the body's id.
#define ASP_LEVEL_STRIKE_GAIN 3

/// A surface.
#define ASP_SURFACE 1

/// A body.
#define ASP_BODY 2

/// A probe.
#define ASP_PROBE 3

/// As the call says: steel for a striker, the engine's default material for a body.
#define ASP_MATERIAL_DEFAULT 0

/// Carbon steel, ground.
#define ASP_MATERIAL_STEEL 1

/// Grey cast iron.
#define ASP_MATERIAL_IRON 2

/// Aluminium alloy.
#define ASP_MATERIAL_ALUMINIUM 3

/// Brass.
#define ASP_MATERIAL_BRASS 4

/// Copper.
#define ASP_MATERIAL_COPPER 5

/// Soda-lime glass.
#define ASP_MATERIAL_GLASS 6

/// Glazed stoneware.
#define ASP_MATERIAL_CERAMIC 7

/// Granite.
#define ASP_MATERIAL_STONE 8

/// Structural concrete.
#define ASP_MATERIAL_CONCRETE 9

/// Fired clay brick.
#define ASP_MATERIAL_BRICK 10

/// Hardwood along the grain, planed.
#define ASP_MATERIAL_WOOD 11

/// Spruce or fir along the grain, planed.
#define ASP_MATERIAL_SOFTWOOD 12

/// Printed PLA; the default of bodies.
#define ASP_MATERIAL_PLA 13

/// Polycarbonate.
#define ASP_MATERIAL_PLASTIC 14

/// Acrylic glass.
#define ASP_MATERIAL_ACRYLIC 15

/// Soft rubber.
#define ASP_MATERIAL_RUBBER 16

/// Fingernail.
#define ASP_MATERIAL_NAIL 17

/// Woven cotton, several layers.
#define ASP_MATERIAL_CLOTH 18

/// Denim.
#define ASP_MATERIAL_DENIM 19

/// Vegetable-tanned leather.
#define ASP_MATERIAL_LEATHER 20

/// Skin over soft tissue.
#define ASP_MATERIAL_SKIN 21

/// Upholstery foam.
#define ASP_MATERIAL_FOAM 22

/// Cut-pile carpet.
#define ASP_MATERIAL_CARPET 23

/// Corrugated board, taken as one piece.
#define ASP_MATERIAL_CARDBOARD 24

/// Stacked paper.
#define ASP_MATERIAL_PAPER 25

/// Pressed cork.
#define ASP_MATERIAL_CORK 26

/// Moist soil.
#define ASP_MATERIAL_SOIL 27

/// A striker whose elastic constants stand in the event.
#define ASP_MATERIAL_CUSTOM 255

/// Form of a collider that does not roll.
#define ASP_FORM_FLAT 0

/// Sphere.
#define ASP_FORM_SPHERE 1

/// Capsule along its own z.
#define ASP_FORM_CAPSULE 2

/// Cylinder along its own z.
#define ASP_FORM_CYLINDER 3

/// Most colliders of a world.
#define ASP_MAX_COLLIDERS 65536

/// A pickup reads m/s2, with what the body does as a whole.
#define ASP_PICKUP_ACCELERATION 0

/// A pickup reads m/s, of the vibration.
#define ASP_PICKUP_VELOCITY 1

/// A pickup reads m, of the vibration.
#define ASP_PICKUP_DISPLACEMENT 2

/// Most channels of pickups of an engine that is built or loaded here.
#define ASP_MAX_PICKUPS 64

/// Samples, exactly as they leave: read with `asp_port_pcm`.
#define ASP_PORT_PCM 1

/// An amplitude and a frequency some hundred times a second: read with `asp_port_points`.
#define ASP_PORT_POINTS 2

/// Levels of a heavy and a light motor: read with `asp_port_levels`.
#define ASP_PORT_LEVELS 3

/// The 3-D force of contacts and hands: read with `asp_port_forces`.
#define ASP_PORT_FORCES 4

/// A haptic channel.
#define ASP_FEED_HAPTIC 0

/// An audio bus.
#define ASP_FEED_BUS 1

/// Most frames of one call; a longer one renders nothing.
#define ASP_MAX_FRAMES 16777216

/// Most channels of an interleaved buffer; with more nothing is rendered.
#define ASP_MAX_WIDTH 256

/// In a channel map: this channel is silent. From 0 on it is an audio bus.
#define ASP_SILENT -1

/// In a channel map: ASP_HAPTIC + i is haptic channel i.
#define ASP_HAPTIC 1000

/// Most events of one call.
#define ASP_MAX_EVENTS 65536

/// It is done.
#define ASP_OK 0

/// A pointer, a size, a count or a text that cannot be.
#define ASP_BAD_ARGUMENT -1

/// No such handle: freed already, of another kind, or never given out.
#define ASP_BAD_HANDLE -2

/// Another thread is inside a call with this handle.
#define ASP_BUSY -3

/// A number or a word that the engine refuses.
#define ASP_REFUSED -4

/// An id or a name that is not, or no longer, in this scene.
#define ASP_UNKNOWN -5

/// A queue or a table is full; later it may have room.
#define ASP_FULL -6

/// A file that cannot be read or written, or does not hold what it should.
#define ASP_FILE -7

/// No such sound card, or the system refuses it.
#define ASP_DEVICE -8

/// This build of the library cannot do it.
#define ASP_UNSUPPORTED -9

/// The header that the program was compiled with is not of this library.
#define ASP_ABI_MISMATCH -10

/// A fault of this library. The handle is silent from now on and can only be freed.
#define ASP_PANIC -11

/// Beyond uv 0 to 1 it repeats.
#define ASP_WRAP_REPEAT 0

/// Beyond its edge it is as at the edge.
#define ASP_WRAP_CLAMP 1

/// Every second tile is mirrored.
#define ASP_WRAP_MIRROR 2

/// Grey, or the luma of a colour picture.
#define ASP_CHANNEL_LUMA 0

/// Red.
#define ASP_CHANNEL_R 1

/// Green.
#define ASP_CHANNEL_G 2

/// Blue.
#define ASP_CHANNEL_B 3

/// Alpha.
#define ASP_CHANNEL_A 4

/// Version of the interface: a program that was compiled with another one is refused by
/// `asp_check_abi`.
#define ASP_ABI 1

/// Number of structs in the header, in the order in which `asp_check_abi` takes their sizes.
#define ASP_STRUCTS 18

/// Colliders of a simulated world, and what pairs of them do.
typedef struct asp_pairs asp_pairs;

/// An engine that plays on a sound card.
typedef struct asp_player asp_player;

/// The reading end of a port: what leaves the engine, for any one thread.
typedef struct asp_port asp_port;

/// The audio half of an engine: renders. One thread at a time.
typedef struct asp_renderer asp_renderer;

/// The game's half of an engine: takes bodies, surfaces and events. One thread at a time.
typedef struct asp_scene asp_scene;

/// Receiver of a file's bytes: valid within that one call of its function.
typedef struct asp_sink asp_sink;

/// A tracked tip.
typedef struct asp_tip asp_tip;

/// A mode: amplitude e^(-decay_per_s t) sin(2 pi  frequency_hz t + phase_rad).
typedef struct asp_mode {
    /// Frequency, Hz.
    double frequency_hz;
    /// Decay, 1/s.
    double decay_per_s;
    /// Amplitude after the impulse that the body's modes are given for.
    double amplitude;
    /// Phase at the onset, rad.
    double phase_rad;
} asp_mode;

/// Asked for the file at `path` (as the scene writes it, relative to the scene file). Puts its
/// bytes with `asp_sink_bytes`, or a decoded picture with `asp_sink_picture`, and gives 0; anything
/// else: there is no such file.
typedef int32_t (*asp_read)(void *user, const char *path, struct asp_sink *sink);

/// Source of files; `asp_files_init` fills it. NULL wherever it is asked for means the disk.
typedef struct asp_files {
    /// Size of this struct, bytes.
    uint32_t struct_size;
    /// 0.
    uint32_t reserved;
    /// Given to `read` as it is.
    void *user;
    /// Called on the thread that asked for something to be loaded, before that call returns; NULL =
    /// the disk.
    asp_read read;
} asp_files;

/// A body; `asp_body_init` fills it. Its modes are one of `stock`, `modes`, `modes_json` and those
/// that `table` names; none = silent.
typedef struct asp_body {
    /// Size of this struct, bytes.
    uint32_t struct_size;
    /// Material: ASP_MATERIAL_...
    uint32_t material;
    /// Audio bus on which it sounds, from 0.
    uint32_t bus;
    /// Number of `modes`.
    uint32_t mode_count;
    /// Gain, linear, 0 to 1000.
    double gain;
    /// Name in `asp_find`, logs and recordings; NULL = none.
    const char *name;
    /// A stock shape: "bar", "tube", "ring", "plate", "disc", "bowl", "block", "box", "can",
    /// "bottle", "pan", "barrel" or "door".
    const char *stock;
    /// Longest side or diameter of the stock shape, m.
    double size_m;
    /// Modes as numbers.
    const struct asp_mode *modes;
    /// The strike that `modes` is the answer to, N s.
    double impulse_n_s;
    /// The text of a modes file.
    const char *modes_json;
    /// Keys of a scene file's `[[body]]`, TOML: a file of modes, a material's constants, ...; the
    /// fields above count more.
    const char *table;
    /// Place of the files that `table` names; NULL = the disk.
    const struct asp_files *files;
    /// Gain of impacts relative to strokes, linear, 0 to 1000, 1 = as mechanics says; NAN = as
    /// `table` says, else as the level policy has found for the bodies of a scene file, else 1.
    /// (Since 0.1.1.)
    double strike_gain;
} asp_body;

/// Settings of a new engine; `asp_config_init` fills it.
typedef struct asp_config {
    /// Size of this struct, bytes.
    uint32_t struct_size;
    /// ASP_CLOCK_...; the device's unless said.
    uint32_t clock;
    /// Rate of every output, Hz, 8000 to 384000; 0 = as `more` or the scene file says, else 44100.
    double sample_rate_hz;
    /// Seed of the micro-noise; 0 = as `more` or the scene file says, else 1.
    uint64_t seed;
    /// Haptic channels, 1 to 64; 0 = as `more` or the scene file says, else one of 0.1 mm at full
    /// scale.
    uint32_t haptic_channels;
    /// Audio buses, 1 to 64; 0 = as `more` or the scene file says, else one.
    uint32_t audio_buses;
    /// ASP_KERNEL_...
    uint32_t kernel;
    /// Channels of pickups in SI units, 1 to 64; 0 = as `more` or the scene file says, else none.
    /// (Since 0.1.6; before, a 0 that was reserved.)
    uint32_t pickup_channels;
    /// Everything else as TOML or JSON, for instance "max_contacts = 128"; NULL = the engine's
    /// defaults. The fields above count more. Not beside a scene file, which says these things
    /// itself.
    const char *more;
} asp_config;

/// One report; `asp_event_init` fills it with "not told", `asp_begin`, `asp_move`, `asp_end` and
/// `asp_impact` with the usual.
typedef struct asp_event {
    /// Size of this struct, bytes.
    uint32_t struct_size;
    /// ASP_BEGIN, ASP_MOVE, ASP_END or ASP_IMPACT.
    uint32_t kind;
    /// begin, move, end: the contact's name, chosen by the program, unique among those that touch.
    uint64_t contact;
    /// begin: what is touched.
    uint64_t surface;
    /// impact: what rings.
    uint64_t body;
    /// impact: the striker's own body, which rings too; 0 = none.
    uint64_t other;
    /// begin, impact: the body in the hand, which rings too; 0 = none.
    uint64_t holder;
    /// begin, impact: what touches; 0 = the engine's own probe.
    uint64_t probe;
    /// begin, impact: the haptic channel that feels it; -1 = nobody.
    int32_t actuator;
    /// impact: what the striker is made of, ASP_MATERIAL_...; ASP_MATERIAL_CUSTOM = as the three
    /// striker_ numbers say.
    uint32_t striker;
    /// impact: which of the body's strike positions, from 0.
    uint32_t position;
    /// 0.
    uint32_t reserved;
    /// begin, move: texture coordinates; 1 spans the surface's width and height.
    double uv[2];
    /// begin, move: along u and v, m/s; NAN = estimated from uv.
    double velocity_m_s[2];
    /// begin, move: force onto the surface, N.
    double normal_force_n;
    /// begin: approach speed at landing, m/s.
    double closing_m_s;
    /// begin, move: how deep the tip stands below the untouched surface, m, where that gives way;
    /// NAN = the force counts.
    double depth_m;
    /// Place in the body's frame, m; NAN = not told.
    double at_m[3];
    /// impact: along what it is hit, in the body's frame; NAN = the inward normal.
    double direction[3];
    /// Gain of what is felt and heard, 0 to 1000; NAN = 1, of a move: as it was.
    double gain;
    /// begin, move: factor of the priority; NAN = 1, of a move: as it was.
    double importance;
    /// impact: approach speed, m/s.
    double speed_m_s;
    /// impact: the striker's effective mass, kg.
    double mass_kg;
    /// impact: its radius where it strikes, m.
    double radius_m;
    /// impact: rebound over approach speed, 0 to 1.
    double restitution;
    /// Young's modulus of a striker of ASP_MATERIAL_CUSTOM, Pa.
    double striker_young_pa;
    /// Its Poisson ratio.
    double striker_poisson;
    /// Its density, kg/m3.
    double striker_density_kg_m3;
    /// begin, move: speed at which what touches slides on the ground there, m/s; 0 = it rolls, NAN
    /// = as fast as it moves: a stroke. Each report tells it anew. (Since 0.1.1.)
    double slip_m_s;
    /// begin, move: radius of what rolls, m; NAN = the probe's tip, at least 8 mm. (Since 0.1.1.)
    double roll_radius_m;
} asp_event;

/// A decoded picture: rows from the top, samples of a pixel beside each other. All zero = none.
typedef struct asp_image {
    /// First sample of the first row; aligned as its samples are.
    const void *samples;
    /// From one row to the next, bytes; 0 = rows without gaps.
    uint64_t stride_bytes;
    /// Pixels a row, up to 32768.
    uint32_t width;
    /// Rows, up to 32768; up to 2^26 pixels in all.
    uint32_t height;
    /// ASP_U8, ASP_U16 or ASP_F32.
    uint32_t format;
    /// 1 grey, 2 grey and alpha, 3 red, green and blue, 4 the same and alpha.
    uint32_t channels;
} asp_image;

/// A collider for its whole life; `asp_collider_init` fills it.
typedef struct asp_collider {
    /// Size of this struct, bytes.
    uint32_t struct_size;
    /// Material: ASP_MATERIAL_...
    uint32_t material;
    /// ASP_FORM_...
    uint32_t form;
    /// The haptic channel that feels it; -1 = nobody.
    int32_t actuator;
    /// Body that it rings as; 0 = none.
    uint64_t body;
    /// Surface that others scrape on it; 0 = none.
    uint64_t surface;
    /// Width and height of that surface, m.
    double surface_m[2];
    /// Mass, kg; INFINITY for what nothing moves.
    double mass_kg;
    /// Radius of a sphere or a capsule, m.
    double radius_m;
} asp_collider;

/// Place and motion of a collider after a step.
typedef struct asp_placed {
    /// Origin of its own space, m.
    double place_m[3];
    /// Turn from its own space to the world's, row by row.
    double rotation[9];
    /// Velocity of that origin, m/s.
    double velocity_m_s[3];
    /// rad/s.
    double angular_velocity_rad_s[3];
} asp_placed;

/// A point at which two colliders press.
typedef struct asp_touch {
    /// The two, by the order in which they were added.
    uint32_t colliders[2];
    /// Place, m.
    double point_m[3];
    /// Direction from the first to the second.
    double normal[3];
    /// Along the normal, N.
    double force_n;
    /// Rebound over approach speed, 0 to 1.
    double restitution;
} asp_touch;

/// A pickup; `asp_pickup_init` fills it.
typedef struct asp_pickup {
    /// Size of this struct, bytes.
    uint32_t struct_size;
    /// Channel that it is read on, from 0; those of one channel add up.
    uint32_t channel;
    /// ASP_PICKUP_...
    uint32_t quantity;
    /// 0.
    uint32_t reserved;
    /// Place on a body that has shapes, m in its frame, at most 1 % of its size off its surface; on
    /// another the arm of its rigid motion. NAN = none.
    double at_m[3];
    /// Along what it reads, in the body's frame; NAN = the outward normal.
    double direction[3];
    /// On a body of known mass without shapes, how much it moves with every mode, -1 to 1: 1 as
    /// where that swings most. NAN = at a place.
    double factor;
} asp_pickup;

/// Motion of a body as a whole at an instant, in its own axes.
typedef struct asp_motion {
    /// Acceleration of its centre, m/s2.
    double acceleration_m_s2[3];
    /// Gravity, m/s2.
    double gravity_m_s2[3];
    /// rad/s.
    double angular_velocity_rad_s[3];
    /// Centre that the acceleration belongs to, m.
    double centre_m[3];
} asp_motion;

/// Settings of a player; `asp_player_config_init` fills it for the default device.
typedef struct asp_player_config {
    /// Size of this struct, bytes.
    uint32_t struct_size;
    /// Not 0: play to nobody, in real time; works in every build and on every machine.
    uint32_t silent;
    /// Frames a block to ask for, 1 to 65536; 0 = the device's, or 256.
    uint32_t block_frames;
    /// 0.
    uint32_t reserved;
    /// Host by name ("alsa", "wasapi", "coreaudio", ...); NULL = the system's.
    const char *host;
    /// Device by its id; NULL = the default one.
    const char *device;
    /// A second device for the haptic channels; NULL = none.
    const char *haptic_device;
    /// Signals of its channels, for instance "audio=0,1 haptic=2,3"; NULL = just that.
    const char *channels;
} asp_player_config;

/// Report of a player; `asp_player_report_init` fills in the size.
typedef struct asp_player_report {
    /// Size of this struct, bytes.
    uint32_t struct_size;
    /// Not 0: it plays to nobody.
    uint32_t silent;
    /// Callbacks, or blocks, so far.
    uint64_t callbacks;
    /// Glitches that the device reported, or blocks that were late.
    uint64_t underruns;
    /// Times the stream was built anew after the device was lost.
    uint64_t rebuilt;
    /// From callback to ear or skin, s, as the device tells.
    double latency_s;
    /// Mean share of the time that rendering took.
    double mean_load;
    /// Longest share of a callback's time.
    double peak_load;
} asp_player_report;

/// Settings of a port; `asp_port_config_init` fills it for 0.1 s of haptic channel 0.
typedef struct asp_port_config {
    /// Size of this struct, bytes.
    uint32_t struct_size;
    /// ASP_PORT_...
    uint32_t kind;
    /// Which signal: ASP_FEED_...; forces are of all contacts.
    uint32_t feed;
    /// Which channel or bus, from 0.
    uint32_t index;
    /// Points, levels or forces a second, Hz.
    double rate_hz;
    /// Time that a late reader still finds, s, 0.001 to 60.
    double holds_s;
    /// Lowest frequency of points that the device plays, Hz.
    double low_hz;
    /// The highest.
    double high_hz;
    /// Frequency of points: 0 = it is drawn, so that every band has its share; 1 = the strongest.
    uint32_t strongest;
    /// 0.
    uint32_t reserved;
} asp_port_config;

/// A vibration between two ticks.
typedef struct asp_point {
    /// It begins tick / rate_hz seconds after the port was opened.
    uint64_t tick;
    /// Peak of the sine, in the unit of the samples.
    double amplitude;
    /// Its frequency, Hz.
    double frequency_hz;
    /// Peak of what is below 100 Hz.
    double low;
    /// Peak of what is above.
    double high;
} asp_point;

/// A force at one tick.
typedef struct asp_force {
    /// It is tick / rate_hz seconds after sample 0.
    uint64_t tick;
    /// The contact's name, or the haptic channel.
    uint64_t of;
    /// 1 = of a hand: the sum of all contacts that its haptic channel feels; 0 = of one contact.
    uint64_t is_hand;
    /// Along u, v and out of the surface, N.
    double force_n[3];
} asp_force;

/// Counts since the engine was built; `asp_stats_init` fills in the size.
typedef struct asp_stats {
    /// Size of this struct, bytes.
    uint32_t struct_size;
    /// Share of the time budget that the last blocks took, as told by `asp_report_load`.
    float load;
    /// Samples rendered.
    uint64_t position;
    /// Events applied by the audio half.
    uint64_t events;
    /// Impacts among them.
    uint64_t impacts;
    /// Impacts whose contact would outlast 0.17 s and was shortened.
    uint64_t shortened;
    /// Micro-collisions that would outlast 0.04 s and were shortened.
    uint64_t shortened_collisions;
    /// Onsets of contact found by the micro-contact model.
    uint64_t micro_collisions;
    /// Blows of a probe that had left the ground, and flights from a crest that its leash ended.
    uint64_t blows;
    /// Events handed back because the queue was full.
    uint64_t dropped;
    /// Moves that a newer event made pointless before they were sent.
    uint64_t superseded;
    /// Events that named a contact nobody began, or whose voice was stolen.
    uint64_t orphaned;
    /// Contacts silenced because a more important one needed the voice.
    uint64_t stolen;
    /// Landings right after a lift-off at the same place, taken as one contact.
    uint64_t debounced;
    /// Contacts faded because nothing was heard of them.
    uint64_t lapsed;
    /// Contacts that were suddenly elsewhere.
    uint64_t jumps;
    /// Reports of no force.
    uint64_t unpressed;
    /// Events refused: bad numbers, unknown ids, time running backwards.
    uint64_t refused;
    /// Contacts reset on the audio half after their numbers went bad.
    uint64_t quarantined;
    /// Events that arrived after the sample they were stamped for.
    uint64_t late;
    /// Times the game clock was tied to the audio clock anew.
    uint64_t clock_jumps;
    /// Times the game was found to run at another pace.
    uint64_t clock_paces;
    /// Lead of the latest event's stamp over the audio, samples.
    uint64_t ahead;
    /// Pieces of work left out because blocks ran late.
    uint64_t shed;
    /// Contacts sounding now.
    uint64_t contacts;
    /// By how much the peak limiters have turned down at most, whole dB. (Since 0.1.1.)
    uint64_t limiter_db;
    /// Contacts that would have rubbed a body that another one rubs already, a count for each 64
    /// samples. (Since 0.1.1.)
    uint64_t rubs_crowded_out;
    /// Reports beyond what the models reach, which counted as the limit. (Since 0.1.3.)
    uint64_t held;
    /// Impacts dropped because audio stood still when they were reported. (Since 0.1.3.)
    uint64_t stale;
    /// Impacts dropped because they came within `least_time_s` of their body. (Since 0.1.3.)
    uint64_t too_soon;
    /// Bodies that were removed and faded before they had rung out. (Since 0.1.3.)
    uint64_t given_way;
} asp_stats;

/// A surface; `asp_surface_init` fills it. A number that is NAN is not told: then `table`, the
/// body's material or the engine's default says it. Without `heights` and without a source in
/// `table` it is a plane with the finish of its body's material.
typedef struct asp_surface {
    /// Size of this struct, bytes.
    uint32_t struct_size;
    /// ASP_WRAP_...
    uint32_t wrap;
    /// The body that rings when it is touched; 0 = none, or the one that `table` names.
    uint64_t body;
    /// Name in `asp_find`, logs and recordings; NULL = none.
    const char *name;
    /// Span of uv 0 to 1 along u, m.
    double width_m;
    /// Span of uv 0 to 1 along v, m.
    double height_m;
    /// Height of a sample of full scale (255, 65535 or 1.0) above 0, m; 1 if the heights are
    /// metres.
    double relief_m;
    /// Displacement map.
    struct asp_image heights;
    /// Roughness map, 0 to 1.
    struct asp_image roughness_map;
    /// Which samples of a pixel of `heights`: ASP_CHANNEL_...
    uint32_t heights_channel;
    /// Which samples of a pixel of `roughness_map`: ASP_CHANNEL_...
    uint32_t roughness_channel;
    /// Roughness 0 to 1, the same everywhere, where there is no map.
    double roughness;
    /// Rms of the micro-relief in the octave about 1 mm at roughness 1, m.
    double micro_relief_m;
    /// Coulomb friction of the force.
    double friction;
    /// Compliance, m/N; 0 = hard.
    double compliance_m_n;
    /// Keys of a scene file's `[[surface]]`, TOML: solid = "granite", sand = { ... }, files of maps,
    /// ...; the fields above count more.
    const char *table;
    /// Place of the files that `table` names; NULL = the disk.
    const struct asp_files *files;
} asp_surface;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/// Fills a body of `size` bytes, sizeof(asp_body), with that size and the defaults. A size that
/// never was fills nothing.
void asp_init_body(struct asp_body *body, uint32_t size);

/// Adds a body and gives its id, which is never 0.
int32_t asp_add_body(struct asp_scene *scene, const struct asp_body *body, uint64_t *id);

/// Gives a body other modes, material, bus and gain while it sounds; what rings rings out under the
/// new. Its name stays.
int32_t asp_replace_body(struct asp_scene *scene, uint64_t id, const struct asp_body *body);

/// Takes a body away; it rings out until it sleeps. Its id is refused from then on.
int32_t asp_remove_body(struct asp_scene *scene, uint64_t id);

/// Lets a body sound on another bus, without a click.
int32_t asp_set_body_bus(struct asp_scene *scene, uint64_t id, uint32_t bus);

/// Lets a body sound on a bus beside its own, so loud, linear, 0 to 1000, without a step; 0 for no
/// longer. At most four: a bus for each listener.
int32_t asp_set_body_send(struct asp_scene *scene, uint64_t id, uint32_t bus, double gain);

/// Makes a body louder or softer, linear, 0 to 1000, without a step.
int32_t asp_set_body_gain(struct asp_scene *scene, uint64_t id, double gain);

/// Plays a clip on a haptic channel from game time `time_s` on: `count` samples at `rate_hz`, 1 =
/// the channel's full scale, times `gain`; strokes and blows have the gain `ducking` (0 to 1)
/// meanwhile. It is added before the user's gain, the equaliser and the limiters; its ends are
/// faded over 2 ms. 32 play at once, more are dropped. The samples are copied.
int32_t asp_play_clip(struct asp_scene *scene,
                      double time_s,
                      uint32_t channel,
                      const float *samples,
                      uint32_t count,
                      double rate_hz,
                      double gain,
                      double ducking);

/// Fills a config with its size and the defaults: a live clock, one haptic channel, one bus.
void asp_config_init(struct asp_config *config);

/// Builds an engine: one half for the game's thread, one for the audio thread.
int32_t asp_build(const struct asp_config *config, struct asp_scene **scene, struct asp_renderer **renderer);

/// Fills an event of `size` bytes, sizeof(asp_event), with that size and "not told": a loss-free
/// blow of 4 g of steel at 1 m/s where it is an impact. A size that never was fills nothing.
void asp_init_event(struct asp_event *event, uint32_t size);

/// Fills files with its size and the disk.
void asp_files_init(struct asp_files *files);

/// Puts the bytes of a file that was asked for; they are copied.
int32_t asp_sink_bytes(struct asp_sink *sink, const uint8_t *bytes, size_t size);

/// Puts a picture that was asked for and is decoded already; it is copied.
int32_t asp_sink_picture(struct asp_sink *sink, const struct asp_image *image);

/// Frees a scene; null is nothing. Its renderer and ports may live on: they ring out. Not on the
/// audio thread.
int32_t asp_scene_free(struct asp_scene *scene);

/// Frees a renderer; null is nothing. Waits until no other thread renders with it. Not on the audio
/// thread.
int32_t asp_renderer_free(struct asp_renderer *renderer);

/// Frees a tip; null is nothing. It ends no contact: report the end of what it touches.
int32_t asp_tip_free(struct asp_tip *tip);

/// Frees a world of pairs; null is nothing. It ends no contact.
int32_t asp_pairs_free(struct asp_pairs *pairs);

/// Closes a port; null is nothing.
int32_t asp_port_free(struct asp_port *port);

/// The user's gain of a haptic channel, 0 (mute) to 10.
int32_t asp_set_haptic_gain(struct asp_scene *scene, uint32_t channel, double gain);

/// The gain of an audio bus, 0 to 1e6.
int32_t asp_set_bus_gain(struct asp_scene *scene, uint32_t bus, double gain);

/// All that is felt and heard fades within 20 ms (not 0), or comes back (0); everything goes on
/// meanwhile.
int32_t asp_set_muted(struct asp_scene *scene, uint32_t muted);

/// The game stands still (not 0): contacts wait, however long. Or it goes on (0).
int32_t asp_set_paused(struct asp_scene *scene, uint32_t paused);

/// Every contact ends and what rings is damped within a tenth of a second: for a cut, a menu, the
/// end of a level.
int32_t asp_fade_all(struct asp_scene *scene);

/// A level in use, whether the program, the scene file or the level policy has said it: ASP_LEVEL_...
/// `of` says of what.
int32_t asp_get_level(struct asp_scene *scene, uint32_t kind, uint64_t of, double *level);

/// Builds the engine of a scene file. `text` NULL: `path` is read from `files`; else `text` is the
/// scene, and `path` says only where it would lie. `files` NULL: the disk. Of `config` (NULL: the
/// defaults) clock, rate, seed and kernel count. With a live clock, sand is simulated on threads of
/// its own and every bus has a limiter, as before a sound card.
int32_t asp_load(const char *path,
                 const char *text,
                 const struct asp_files *files,
                 const struct asp_config *config,
                 struct asp_scene **scene,
                 struct asp_renderer **renderer);

/// The id of a surface, body or probe by its name in the scene file, or by the name it was added
/// with.
int32_t asp_find(struct asp_scene *scene, uint32_t kind, const char *name, uint64_t *id);

/// Reads the text of a contact log (JSON Lines; docs/formats/log.md) into `events` and `times_s`,
/// both of `capacity`, with the ids that the scene's names stand for. `count` is how many events
/// the log holds: call once with a capacity of 0 to learn it. `size` is sizeof(asp_event). A log
/// that holds edits of a scene, or motions of bodies, is refused.
int32_t asp_read_log(struct asp_scene *scene,
                     const char *text,
                     struct asp_event *events,
                     double *times_s,
                     uint32_t capacity,
                     uint32_t size,
                     uint32_t *count);

/// The number of a material, by the name that scene files use: "steel", "wood", ...
int32_t asp_material(const char *name, uint32_t *number);

/// Fills a collider with its size and the defaults: it rings as nothing, has no surface, and
/// nothing moves it.
void asp_collider_init(struct asp_collider *collider);

/// Makes an empty world of pairs for a scene, before its surfaces are added: what touches them
/// rides them with probes of its own.
int32_t asp_pairs_new(struct asp_scene *scene, struct asp_pairs **pairs);

/// Adds a collider; `index` is its number in `asp_touch` and its place among `asp_placed`.
int32_t asp_pairs_add(struct asp_pairs *pairs, const struct asp_collider *collider, uint32_t *index);

/// Takes a step of a simulator and reports to the scene, at game time `time_s`, what strikes,
/// slides, rolls, rests and leaves: `placed` has an entry for each collider, `touches` one for each
/// point of contact. Times grow; a step that is refused for its numbers was not taken. `events`
/// (may be NULL) is how many were accepted, and the first refusal by the scene is the status.
int32_t asp_pairs_step(struct asp_pairs *pairs,
                       struct asp_scene *scene,
                       double time_s,
                       double step_s,
                       const struct asp_placed *placed,
                       const struct asp_touch *touches,
                       uint32_t count,
                       uint32_t *events);

/// Fills a pickup with its size and the defaults: the acceleration along the outward normal, on
/// channel 0, at a place that has to be told, or with a factor.
void asp_pickup_init(struct asp_pickup *pickup);

/// Puts a pickup on a body; `asp_config.pickup_channels` says how many channels there are. What the
/// body rings rings out unread.
int32_t asp_pickup_add(struct asp_scene *scene, uint64_t body, const struct asp_pickup *pickup);

/// Reports at game time `time_s` how a body moves as a whole: its accelerometers read it from then
/// on.
int32_t asp_pickup_motion(struct asp_scene *scene, double time_s, uint64_t body, const struct asp_motion *motion);

/// Number of a renderer's channels of pickups; they lag as sound does (`asp_signals`).
int32_t asp_pickup_channels(struct asp_renderer *renderer, uint32_t *channels);

/// `asp_render`, and what the pickups read of the same frames: channel i into `pickups[i]`, in
/// m/s2, m/s or m, behind a sensor in volts.
void asp_pickup_render(struct asp_renderer *renderer,
                       float *const *haptic,
                       uint32_t haptic_channels,
                       float *const *audio,
                       uint32_t audio_buses,
                       float *const *pickups,
                       uint32_t pickup_channels,
                       uint32_t frames);

/// Fills a player's config with its size and the defaults.
void asp_player_config_init(struct asp_player_config *config);

/// Fills a report with its size.
void asp_player_report_init(struct asp_player_report *report);

/// Plays until `asp_player_stop`. The renderer belongs to the player from then on: its handle ends,
/// also where the device refuses. Where a sentence is refused before (a map, a build without sound
/// cards) it stays.
int32_t asp_play(struct asp_renderer *renderer, const struct asp_player_config *config, struct asp_player **player);

/// Which device plays, or why nobody hears it. `size` is the room in `words`, bytes; what does not
/// fit is cut.
int32_t asp_player_device(struct asp_player *player, char *words, uint32_t size);

/// Report of the player so far; one that plays to nobody tells it only when it is stopped.
int32_t asp_get_player_report(struct asp_player *player, struct asp_player_report *report);

/// Stops and frees a player; null is nothing. `report` (may be NULL) is what it met.
int32_t asp_player_stop(struct asp_player *player, struct asp_player_report *report);

/// Fills a port's config with its size and the defaults.
void asp_port_config_init(struct asp_port_config *config);

/// Opens a port; it shows what leaves from the next block on, until it is freed.
int32_t asp_open_port(struct asp_scene *scene, const struct asp_port_config *config, struct asp_port **port);

/// The oldest samples that are left, at most `count`; how many there were.
uint32_t asp_port_pcm(struct asp_port *port, float *samples, uint32_t count);

/// The oldest points that are left, at most `count`; how many there were.
uint32_t asp_port_points(struct asp_port *port, struct asp_point *points, uint32_t count);

/// The newest levels of a heavy and a light motor, as peaks of sines in the unit of the samples; 0
/// where there are none.
void asp_port_levels(struct asp_port *port, double *heavy, double *light);

/// The oldest forces that are left, at most `count`; how many there were.
uint32_t asp_port_forces(struct asp_port *port, struct asp_force *forces, uint32_t count);

/// Number that was overwritten before it was read: samples, points, levels or forces.
uint64_t asp_port_lost(struct asp_port *port);

/// Adds a probe and gives its id, which is never 0. `table` is what a scene file's `[[probe]]`
/// says, TOML: preset = "stylus" (fingertip, fingernail, stylus, sole, rigid), and what differs
/// from it. `name` may be NULL. It stays as long as the scene.
int32_t asp_add_probe(struct asp_scene *scene, const char *table, const char *name, uint64_t *id);

/// Records from now on, in memory, what is reported and how the scene is edited, each with the time
/// at which the engine applies it.
int32_t asp_record_start(struct asp_scene *scene);

/// Ends the recording and writes it to `path` (JSON Lines); it is whole or not there. NULL throws
/// it away.
int32_t asp_record_stop(struct asp_scene *scene, const char *path);

/// Renders the next `frames`: haptic channel i into `haptic[i]`, audio bus i into `audio[i]`.
/// Pointers may be NULL, and channels that the engine does not have are silent. A handle that
/// cannot be used, more than 64 channels or more than 2^24 frames: silence, or nothing.
void asp_render(struct asp_renderer *renderer,
                float *const *haptic,
                uint32_t haptic_channels,
                float *const *audio,
                uint32_t audio_buses,
                uint32_t frames);

/// Renders the next `frames` into an interleaved buffer of `channels` channels. `map[c]` says what
/// channel c carries: an audio bus, ASP_HAPTIC + a haptic channel, or ASP_SILENT. `map` NULL: all
/// buses on channels 0 and 1, haptic channels from 2 on.
void asp_render_interleaved(struct asp_renderer *renderer,
                            float *out,
                            uint32_t channels,
                            uint32_t frames,
                            const int32_t *map);

/// Reports which share of its time the last block took (1 = all of it); above that the
/// least audible work is left out. For the audio thread.
void asp_report_load(struct asp_renderer *renderer, float load);

/// Outputs of a renderer: haptic channels, audio buses, their rate in Hz, and by how many samples
/// all of them lag behind the stamps of their events (sound by two samples of the rate inside
/// more). Any of the places may be NULL.
int32_t asp_signals(struct asp_renderer *renderer,
                    uint32_t *haptic_channels,
                    uint32_t *audio_buses,
                    double *sample_rate_hz,
                    uint32_t *latency_samples);

/// Goes on at another rate, after a headset was plugged in: ids, contacts and gains stay, ports
/// end. Not while the audio thread renders.
int32_t asp_set_sample_rate(struct asp_scene *scene, struct asp_renderer *renderer, double sample_rate_hz);

/// Reports what happened at game time `time_s`: `count` events of `size` bytes each
/// (sizeof(asp_event)). All are tried; `taken` (may be NULL) is how many were accepted, and the
/// first refusal is the status. Never blocks.
int32_t asp_report(struct asp_scene *scene,
                   double time_s,
                   const struct asp_event *events,
                   uint32_t count,
                   uint32_t size,
                   uint32_t *taken);

/// Game time begins anew: the next report holds at the sample that is rendered next, whatever its
/// time. For a level that restarts, under the exact clock; a live one finds out by itself.
int32_t asp_reset(struct asp_scene *scene);

/// Sets the game seconds a second of audio, 0.01 to 100, from the last report on; for the exact
/// clock.
int32_t asp_set_time_scale(struct asp_scene *scene, double scale);

/// Sets the game seconds a second of audio, 0.1 to 2, and lets all that is heard and felt bend with
/// it: at 0.5 a bell of 800 Hz rings at 400 Hz, twice as long. For both clocks; 1 ends it.
int32_t asp_bend_time(struct asp_scene *scene, double scale);

/// Reports a strike (an event of kind ASP_IMPACT, of `size` bytes) under a name, for games that
/// predict and roll back: reported again, also for a time that has gone by, it still sounds once,
/// and while it waits the newer report counts. Names are kept for the next 1024.
int32_t asp_report_named(struct asp_scene *scene,
                         double time_s,
                         uint64_t name,
                         const struct asp_event *event,
                         uint32_t size);

/// Takes a strike with a name back: `waited` is 1 where it waited and does not sound, 0 where it
/// has sounded already or is not known.
int32_t asp_withdraw(struct asp_scene *scene, uint64_t name, uint32_t *waited);

/// Fills statistics of `size` bytes, sizeof(asp_stats), with that size. A size that never was fills
/// nothing.
void asp_init_stats(struct asp_stats *stats, uint32_t size);

/// Statistics of the engine so far.
int32_t asp_get_stats(struct asp_scene *scene, struct asp_stats *stats);

/// Peak level of each bus as a meter shows it, linear; buses beyond those of the scene are 0.
int32_t asp_bus_peaks(struct asp_scene *scene, float *peaks, uint32_t count);

/// Reasons against anything being heard or felt, a line a reason, the likeliest first; "" when
/// nothing does. `size` is the room in `reasons`, bytes; what does not fit is cut.
int32_t asp_why_silent(struct asp_scene *scene, char *reasons, uint32_t size);

/// Bodies and surfaces that leave more than full scale holds, by how much, and what to turn: a line
/// a reason, the loudest first; "" when nothing does. It renders a reference strike where one is
/// not known yet. `size` is the room in `reasons`, bytes; what does not fit is cut. (Since 0.1.4.)
int32_t asp_why_clipped(struct asp_scene *scene, char *reasons, uint32_t size);

/// Frees what the audio half no longer needs; adding and replacing do it too. `freed` (may be NULL)
/// is how many things.
int32_t asp_collect(struct asp_scene *scene, uint32_t *freed);

/// Fault of this thread's last call, "" if nothing was. It is never null, and holds
/// until the thread's next call.
const char *asp_last_error(void);

/// Fills a surface with its size and the defaults; its width and height have to be told.
void asp_surface_init(struct asp_surface *surface);

/// Adds a surface and gives its id, which is never 0.
int32_t asp_add_surface(struct asp_scene *scene, const struct asp_surface *surface, uint64_t *id);

/// Changes a surface under the contacts that slide on it, without a click. Its name stays.
int32_t asp_replace_surface(struct asp_scene *scene, uint64_t id, const struct asp_surface *surface);

/// Takes a surface away; contacts on it fade. Its id is refused from then on.
int32_t asp_remove_surface(struct asp_scene *scene, uint64_t id);

/// Makes a tracked tip over `count` surfaces that have a frame (`frame` of `asp_surface.table`); a
/// hand has one for each finger. `stiffness_n_m`: force over depth, 1 to 1e5, NAN = 200; `mass_kg`:
/// of the proxy that follows along the surface, 1e-3 to 10, NAN = 0.1; `max_force_n`: 1e-3 to 1000,
/// NAN = 5.
int32_t asp_tip_new(struct asp_scene *scene,
                    const uint64_t *surfaces,
                    uint32_t count,
                    double stiffness_n_m,
                    double mass_kg,
                    double max_force_n,
                    struct asp_tip **tip);

/// Moves a tip to `position_m` (x, y, z in the axes of the surfaces' body), `dt_s` after its last
/// step, and fills `event` for `asp_report`: a begin, move or end of `contact`, felt by haptic
/// channel `actuator`; of kind 0 where nothing is touched.
int32_t asp_tip_step(struct asp_tip *tip,
                     double dt_s,
                     const double *position_m,
                     uint64_t contact,
                     int32_t actuator,
                     struct asp_event *event);

/// Ends what a tip touches, because the game has moved the hand elsewhere: fills `event` with the
/// end of `contact`, or with kind 0. The next step starts anew.
int32_t asp_tip_lift(struct asp_tip *tip, uint64_t contact, struct asp_event *event);

/// The number by which the mixer effect "Asperity" finds a renderer: the value of its parameter
/// "Engine".
int32_t asp_unity_slot(struct asp_renderer *renderer, uint32_t *slot);

/// Version of the library: major 65536 + minor 256 + patch.
uint32_t asp_version(void);

/// Tests whether a program and this library fit each other: `abi` is the header's `ASP_ABI`,
/// `sizes` those of its structs in the order config, files, image, mode, body, surface, event,
/// stats, port_config, point, force, player_config, player_report, pickup, motion, collider,
/// placed, touch. One sentence instead of a crash where a library lies beside another one's header;
/// structs of an older header of this interface are understood.
int32_t asp_check_abi(uint32_t abi, const uint32_t *sizes, uint32_t count);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

/* ---- Structs of this header's size ---- */

/** Fills an event with its size and "not told": a loss-free blow of 4 g of steel at 1 m/s where it is an impact. */
static inline void asp_event_init(struct asp_event *event) { asp_init_event(event, (uint32_t)sizeof *event); }

/** Fills statistics with their size. */
static inline void asp_stats_init(struct asp_stats *stats) { asp_init_stats(stats, (uint32_t)sizeof *stats); }

/** Fills a body with its size and the defaults. */
static inline void asp_body_init(struct asp_body *body) { asp_init_body(body, (uint32_t)sizeof *body); }

/* ---- The usual events ---- */

/** A contact lands at uv (u, v) with a force, felt by haptic channel `actuator` (-1: by nobody). */
static inline struct asp_event asp_begin(uint64_t contact, uint64_t surface, int32_t actuator, double u, double v,
                                         double normal_force_n) {
    struct asp_event event;
    asp_event_init(&event);
    event.kind = ASP_BEGIN;
    event.contact = contact;
    event.surface = surface;
    event.actuator = actuator;
    event.uv[0] = u;
    event.uv[1] = v;
    event.normal_force_n = normal_force_n;
    return event;
}

/** A contact goes on; its velocity is estimated from where it goes, unless it is set. */
static inline struct asp_event asp_move(uint64_t contact, double u, double v, double normal_force_n) {
    struct asp_event event = asp_begin(contact, 0, -1, u, v, normal_force_n);
    event.kind = ASP_MOVE;
    return event;
}

/** The same begin or move of what rolls: its radius, and how fast what touches slides where it touches, m/s: 0 = it only rolls. */
static inline struct asp_event asp_rolling(struct asp_event event, double radius_m, double slip_m_s) {
    event.roll_radius_m = radius_m;
    event.slip_m_s = slip_m_s;
    return event;
}

/** A contact lifts off. */
static inline struct asp_event asp_end(uint64_t contact) {
    struct asp_event event;
    asp_event_init(&event);
    event.kind = ASP_END;
    event.contact = contact;
    return event;
}

/** A striker of steel hits a body: approach speed, effective mass, radius where it strikes. */
static inline struct asp_event asp_impact(uint64_t body, double speed_m_s, double mass_kg, double radius_m) {
    struct asp_event event;
    asp_event_init(&event);
    event.kind = ASP_IMPACT;
    event.body = body;
    event.speed_m_s = speed_m_s;
    event.mass_kg = mass_kg;
    event.radius_m = radius_m;
    return event;
}

/** What most physics engines tell of a collision: the impulse along the normal, N s, and the approach speed, m/s. */
static inline struct asp_event asp_collision(uint64_t body, double impulse_n_s, double speed_m_s, double restitution) {
    struct asp_event event = asp_impact(body, speed_m_s, 0.0, 0.005);
    event.mass_kg = impulse_n_s / ((speed_m_s > 1e-6 ? speed_m_s : 1e-6) * (1.0 + restitution));
    event.restitution = restitution;
    return event;
}

/** Whether this header and the library that was found belong together: call it once, first. */
static inline int32_t asp_check(void) {
    const uint32_t sizes[ASP_STRUCTS] = {
        (uint32_t)sizeof(struct asp_config),      (uint32_t)sizeof(struct asp_files),
        (uint32_t)sizeof(struct asp_image),       (uint32_t)sizeof(struct asp_mode),
        (uint32_t)sizeof(struct asp_body),        (uint32_t)sizeof(struct asp_surface),
        (uint32_t)sizeof(struct asp_event),       (uint32_t)sizeof(struct asp_stats),
        (uint32_t)sizeof(struct asp_port_config), (uint32_t)sizeof(struct asp_point),
        (uint32_t)sizeof(struct asp_force),       (uint32_t)sizeof(struct asp_player_config),
        (uint32_t)sizeof(struct asp_player_report), (uint32_t)sizeof(struct asp_pickup),
        (uint32_t)sizeof(struct asp_motion),      (uint32_t)sizeof(struct asp_collider),
        (uint32_t)sizeof(struct asp_placed),      (uint32_t)sizeof(struct asp_touch)};
    return asp_check_abi(ASP_ABI, sizes, ASP_STRUCTS);
}

#endif /* ASPERITY_H */
