// asperity for C#: plain P/Invoke, no engine's types, C# 7. The native library is called "asperity" (libasperity.so, asperity.dll,
// libasperity.dylib); in Unity it is "audioplugin_asperity", by a symbol that every Unity defines.
//
// Every refusal is an AsperityException with the engine's sentence. A Scene belongs to one thread at a time; Renderer.Render is for the audio
// thread: it neither throws nor allocates.
using System;
using System.Runtime.InteropServices;
using System.Text;

namespace Asperity
{
    public sealed class AsperityException : Exception
    {
        public readonly int Status;
        public AsperityException(int status, string sentence) : base(sentence) { Status = status; }
    }

    public enum Clock : uint { Live = 0, Exact = 1, More = 2 }
    public enum Kernel : uint { Best = 0, Portable = 1 }
    public enum Kind : uint { Surface = 1, Body = 2, Probe = 3 }
    public enum EventKind : uint { Begin = 1, Move = 2, End = 3, Impact = 4 }
    public enum Wrap : uint { Repeat = 0, Clamp = 1, Mirror = 2 }
    public enum Format : uint { U8 = 0, U16 = 1, F32 = 2 }
    public enum PortKind : uint { Pcm = 1, Points = 2, Levels = 3, Forces = 4 }
    public enum Feed : uint { Haptic = 0, Bus = 1 }
    /// <summary>m or m/s2 at sample value 1 of a haptic channel; gain of a bus; gain of impacts on a body.</summary>
    public enum Level : uint { FullScale = 1, BusGain = 2, StrikeGain = 3 }
    public enum Material : uint
    {
        Default = 0, Steel, Iron, Aluminium, Brass, Copper, Glass, Ceramic, Stone, Concrete, Brick, Wood, Softwood, Pla, Plastic, Acrylic, Rubber,
        Nail, Custom = 255
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct NativeConfig
    {
        public uint StructSize; public Clock Clock; public double SampleRateHz; public ulong Seed;
        public uint HapticChannels; public uint AudioBuses; public Kernel Kernel; public uint Reserved; public IntPtr More;
    }

    [UnmanagedFunctionPointer(CallingConvention.Cdecl)]
    public delegate int ReadFile(IntPtr user, IntPtr path, IntPtr sink);

    [StructLayout(LayoutKind.Sequential)]
    public struct NativeFiles { public uint StructSize; public uint Reserved; public IntPtr User; public IntPtr Read; }

    [StructLayout(LayoutKind.Sequential)]
    public struct NativeImage
    {
        public IntPtr Samples; public ulong StrideBytes; public uint Width; public uint Height; public Format Format; public uint Channels;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct Mode { public double FrequencyHz; public double DecayPerS; public double Amplitude; public double PhaseRad; }

    [StructLayout(LayoutKind.Sequential)]
    public struct NativeBody
    {
        public uint StructSize; public Material Material; public uint Bus; public uint ModeCount; public double Gain;
        public IntPtr Name; public IntPtr Stock; public double SizeM; public IntPtr Modes; public double ImpulseNS;
        public IntPtr ModesJson; public IntPtr Table; public IntPtr Files; public double StrikeGain;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct NativeSurface
    {
        public uint StructSize; public Wrap Wrap; public ulong Body; public IntPtr Name; public double WidthM; public double HeightM; public double ReliefM;
        public NativeImage Heights; public NativeImage RoughnessMap; public uint HeightsChannel; public uint RoughnessChannel;
        public double Roughness; public double MicroReliefM; public double Friction; public double ComplianceMN; public IntPtr Table; public IntPtr Files;
    }

    /// <summary>One report of a physics step; NaN = not told. Begin with Event.Begin, Move, End, Impact or Collision.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct Event
    {
        public uint StructSize; public EventKind Kind; public ulong Contact; public ulong Surface; public ulong Body; public ulong Other; public ulong Holder;
        public ulong Probe; public int Actuator; public Material Striker; public uint Position; public uint Reserved;
        public double U, V, VelocityU, VelocityV, NormalForceN, ClosingMS, DepthM;
        public double AtX, AtY, AtZ, DirectionX, DirectionY, DirectionZ, Gain, Importance;
        public double SpeedMS, MassKg, RadiusM, Restitution, StrikerYoungPa, StrikerPoisson, StrikerDensityKgM3;
        public double SlipMS, RollRadiusM;

        /// <summary>One that tells nothing yet.</summary>
        public static Event New()
        {
            Event e;
            Native.asp_init_event(out e, (uint)Marshal.SizeOf(typeof(Event)));
            return e;
        }

        /// <summary>A contact lands, felt by a haptic channel (-1: by nobody).</summary>
        public static Event Begin(ulong contact, ulong surface, int actuator, double u, double v, double normalForceN)
        {
            var e = Move(contact, u, v, normalForceN);
            e.Kind = EventKind.Begin; e.Surface = surface; e.Actuator = actuator;
            return e;
        }

        public static Event Move(ulong contact, double u, double v, double normalForceN)
        {
            var e = New();
            e.Kind = EventKind.Move; e.Contact = contact; e.U = u; e.V = v; e.NormalForceN = normalForceN;
            return e;
        }

        /// <summary>The same begin or move of what rolls: its radius, and how fast what touches slides where it touches; 0 = it only rolls.</summary>
        public Event Rolling(double radiusM, double slipMS = 0)
        {
            var e = this;
            e.RollRadiusM = radiusM; e.SlipMS = slipMS;
            return e;
        }

        public static Event End(ulong contact)
        {
            var e = New();
            e.Kind = EventKind.End; e.Contact = contact;
            return e;
        }

        public static Event Impact(ulong body, double speedMS, double massKg, double radiusM)
        {
            var e = New();
            e.Kind = EventKind.Impact; e.Body = body; e.SpeedMS = speedMS; e.MassKg = massKg; e.RadiusM = radiusM;
            return e;
        }

        /// <summary>What a physics engine tells of a collision: the impulse along the normal, N s, and the approach speed, m/s.</summary>
        public static Event Collision(ulong body, double impulseNS, double speedMS, double restitution)
        {
            var e = Impact(body, speedMS, impulseNS / (Math.Max(speedMS, 1e-6) * (1 + restitution)), 0.005);
            e.Restitution = restitution;
            return e;
        }
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct Stats
    {
        public uint StructSize; public float Load;
        public ulong Position, Events, Impacts, Shortened, ShortenedCollisions, MicroCollisions, Blows, Dropped, Superseded, Orphaned, Stolen, Debounced,
            Lapsed, Jumps, Unpressed, Refused, Quarantined, Late, ClockJumps, ClockPaces, Ahead, Shed, Contacts, LimiterDb, RubsCrowdedOut, Held, Stale, TooSoon, GivenWay;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct NativePortConfig
    {
        public uint StructSize; public PortKind Kind; public Feed Feed; public uint Index; public double RateHz; public double HoldsS;
        public double LowHz; public double HighHz; public uint Strongest; public uint Reserved;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct Point { public ulong Tick; public double Amplitude; public double FrequencyHz; public double Low; public double High; }

    [StructLayout(LayoutKind.Sequential)]
    public struct Force { public ulong Tick; public ulong Of; public ulong IsHand; public double X, Y, Z; }

    [StructLayout(LayoutKind.Sequential)]
    public struct NativePlayerConfig
    {
        public uint StructSize; public uint Silent; public uint BlockFrames; public uint Reserved;
        public IntPtr Host; public IntPtr Device; public IntPtr HapticDevice; public IntPtr Channels;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct PlayerReport
    {
        public uint StructSize; public uint Silent; public ulong Callbacks; public ulong Underruns; public ulong Rebuilt;
        public double LatencyS; public double MeanLoad; public double PeakLoad;
    }

    public static class Native
    {
#if (UNITY_IOS || UNITY_TVOS) && !UNITY_EDITOR
        public const string Library = "__Internal";
#elif UNITY_5_3_OR_NEWER
        public const string Library = "audioplugin_asperity";
#else
        public const string Library = "asperity";
#endif
        const CallingConvention C = CallingConvention.Cdecl;
        public const uint Abi = 1;

        [DllImport(Library, CallingConvention = C)] public static extern uint asp_version();
        [DllImport(Library, CallingConvention = C)] public static extern IntPtr asp_last_error();
        [DllImport(Library, CallingConvention = C)] public static extern int asp_check_abi(uint abi, uint[] sizes, uint count);
        [DllImport(Library, CallingConvention = C)] public static extern void asp_config_init(out NativeConfig config);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_build(ref NativeConfig config, out IntPtr scene, out IntPtr renderer);
        [DllImport(Library, CallingConvention = C)]
        public static extern int asp_load(byte[] path, byte[] text, IntPtr files, ref NativeConfig config, out IntPtr scene, out IntPtr renderer);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_find(IntPtr scene, Kind kind, byte[] name, out ulong id);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_sink_bytes(IntPtr sink, byte[] bytes, UIntPtr size);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_scene_free(IntPtr scene);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_renderer_free(IntPtr renderer);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_port_free(IntPtr port);
        [DllImport(Library, CallingConvention = C)] public static extern void asp_init_body(out NativeBody body, uint size);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_add_body(IntPtr scene, ref NativeBody body, out ulong id);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_replace_body(IntPtr scene, ulong id, ref NativeBody body);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_remove_body(IntPtr scene, ulong id);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_set_body_bus(IntPtr scene, ulong id, uint bus);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_set_body_send(IntPtr scene, ulong id, uint bus, double gain);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_set_body_gain(IntPtr scene, ulong id, double gain);
        [DllImport(Library, CallingConvention = C)] public static extern void asp_surface_init(out NativeSurface surface);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_add_surface(IntPtr scene, ref NativeSurface surface, out ulong id);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_replace_surface(IntPtr scene, ulong id, ref NativeSurface surface);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_remove_surface(IntPtr scene, ulong id);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_add_probe(IntPtr scene, byte[] table, byte[] name, out ulong id);
        [DllImport(Library, CallingConvention = C)] public static extern void asp_init_event(out Event e, uint size);
        [DllImport(Library, CallingConvention = C)]
        public static extern int asp_report(IntPtr scene, double timeS, [In] Event[] events, uint count, uint size, out uint taken);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_reset(IntPtr scene);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_set_time_scale(IntPtr scene, double scale);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_bend_time(IntPtr scene, double scale);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_report_named(IntPtr scene, double timeS, ulong name, ref Event e, uint size);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_play_clip(IntPtr scene, double timeS, uint channel, [In] float[] samples, uint count, double rateHz, double gain, double ducking);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_withdraw(IntPtr scene, ulong name, out uint waited);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_set_haptic_gain(IntPtr scene, uint channel, double gain);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_set_bus_gain(IntPtr scene, uint bus, double gain);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_get_level(IntPtr scene, Level kind, ulong of, out double level);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_set_muted(IntPtr scene, uint muted);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_set_paused(IntPtr scene, uint paused);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_fade_all(IntPtr scene);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_get_stats(IntPtr scene, ref Stats stats);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_why_silent(IntPtr scene, byte[] reasons, uint size);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_why_clipped(IntPtr scene, byte[] reasons, uint size);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_record_start(IntPtr scene);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_record_stop(IntPtr scene, byte[] path);
        [DllImport(Library, CallingConvention = C)]
        public static extern void asp_render_interleaved(IntPtr renderer, [In, Out] float[] samples, uint channels, uint frames, int[] map);
        [DllImport(Library, CallingConvention = C)] public static extern void asp_report_load(IntPtr renderer, float load);
        [DllImport(Library, CallingConvention = C)]
        public static extern int asp_signals(IntPtr renderer, out uint haptics, out uint buses, out double rateHz, out uint latency);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_set_sample_rate(IntPtr scene, IntPtr renderer, double rateHz);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_unity_slot(IntPtr renderer, out uint slot);
        [DllImport(Library, CallingConvention = C)] public static extern void asp_port_config_init(out NativePortConfig config);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_open_port(IntPtr scene, ref NativePortConfig config, out IntPtr port);
        [DllImport(Library, CallingConvention = C)] public static extern uint asp_port_pcm(IntPtr port, [In, Out] float[] samples, uint count);
        [DllImport(Library, CallingConvention = C)] public static extern uint asp_port_points(IntPtr port, [In, Out] Point[] points, uint count);
        [DllImport(Library, CallingConvention = C)] public static extern void asp_port_levels(IntPtr port, out double heavy, out double light);
        [DllImport(Library, CallingConvention = C)] public static extern uint asp_port_forces(IntPtr port, [In, Out] Force[] forces, uint count);
        [DllImport(Library, CallingConvention = C)] public static extern ulong asp_port_lost(IntPtr port);

        [DllImport(Library, CallingConvention = C)]
        public static extern int asp_tip_new(IntPtr scene, ulong[] surfaces, uint count, double stiffnessNM, double massKg, double maxForceN, out IntPtr tip);
        [DllImport(Library, CallingConvention = C)]
        public static extern int asp_tip_step(IntPtr tip, double dtS, [In] double[] positionM, ulong contact, int actuator, ref Event e);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_tip_lift(IntPtr tip, ulong contact, ref Event e);
        [DllImport(Library, CallingConvention = C)] public static extern int asp_tip_free(IntPtr tip);

        public static readonly Type[] Structs =
        {
            typeof(NativeConfig), typeof(NativeFiles), typeof(NativeImage), typeof(Mode), typeof(NativeBody), typeof(NativeSurface), typeof(Event),
            typeof(Stats), typeof(NativePortConfig), typeof(Point), typeof(Force), typeof(NativePlayerConfig), typeof(PlayerReport)
        };

        /// <summary>Refuses a library that does not belong to this file, in one sentence instead of a crash.</summary>
        public static void Check()
        {
            var sizes = Array.ConvertAll(Structs, type => (uint)Marshal.SizeOf(type));
            Must(asp_check_abi(Abi, sizes, (uint)sizes.Length));
        }

        public static void Must(int status)
        {
            if (status != 0) throw new AsperityException(status, Text(asp_last_error()));
        }

        public static string Text(IntPtr utf8)
        {
            if (utf8 == IntPtr.Zero) return null;
            int length = 0;
            while (Marshal.ReadByte(utf8, length) != 0) length++;
            var bytes = new byte[length];
            Marshal.Copy(utf8, bytes, 0, length);
            return Encoding.UTF8.GetString(bytes);
        }

        /// <summary>A text with the zero byte that C expects; null stays null.</summary>
        public static byte[] Bytes(string text) { return text == null ? null : Encoding.UTF8.GetBytes(text + "\0"); }
    }

    /// <summary>Memory that stays where it is while a call lasts.</summary>
    sealed class Pins : IDisposable
    {
        readonly System.Collections.Generic.List<GCHandle> handles = new System.Collections.Generic.List<GCHandle>();
        public IntPtr Of(object array)
        {
            if (array == null) return IntPtr.Zero;
            var handle = GCHandle.Alloc(array, GCHandleType.Pinned);
            handles.Add(handle);
            return handle.AddrOfPinnedObject();
        }
        public IntPtr Of(string text) { return Of((object)Native.Bytes(text)); }

        /// <summary>Files from wherever a program keeps them; null = the disk.</summary>
        public IntPtr Of(Func<string, byte[]> files)
        {
            if (files == null) return IntPtr.Zero;
            var asked = GCHandle.Alloc(new Asked { Files = files, Pins = this });
            handles.Add(asked);
            var native = new NativeFiles { StructSize = (uint)Marshal.SizeOf(typeof(NativeFiles)), User = GCHandle.ToIntPtr(asked) };
            native.Read = Marshal.GetFunctionPointerForDelegate(Answer);
            return Of((object)native);
        }

        sealed class Asked { public Func<string, byte[]> Files; public Pins Pins; }
        static readonly ReadFile Answer = Read;
        Exception thrown;

#if UNITY_5_3_OR_NEWER
        [AOT.MonoPInvokeCallback(typeof(ReadFile))]
#endif
        static int Read(IntPtr user, IntPtr path, IntPtr sink)
        {
            // No exception may pass through the library: it waits until the call is back.
            var asked = (Asked)GCHandle.FromIntPtr(user).Target;
            try
            {
                var bytes = asked.Files(Native.Text(path));
                return bytes == null ? 1 : Native.asp_sink_bytes(sink, bytes, (UIntPtr)(uint)bytes.Length);
            }
            catch (Exception exception)
            {
                asked.Pins.thrown = exception;
                return 1;
            }
        }

        /// <summary>What a call has answered; what a program's own files have thrown meanwhile counts first.</summary>
        public void Must(int status)
        {
            if (thrown != null) throw thrown;
            Native.Must(status);
        }

        public void Dispose() { foreach (var handle in handles) handle.Free(); }
    }

    /// <summary>A ringing body. One of Stock, Modes, ModesJson, or a Table of a scene file; none = silent.</summary>
    public sealed class Body
    {
        public string Name, Stock, ModesJson, Table;
        public double SizeM, Gain = 1, ImpulseNS = 1;
        /// <summary>How loud impacts are beside strokes, 1 = as mechanics says; NaN = as Table, the scene file or its level policy says, else 1.</summary>
        public double StrikeGain = double.NaN;
        public Material Material;
        public uint Bus;
        public Mode[] Modes;
        /// <summary>Where files lie that Table names; null = the disk.</summary>
        public Func<string, byte[]> Files;

        internal NativeBody Native(Pins pins)
        {
            NativeBody body;
            Asperity.Native.asp_init_body(out body, (uint)Marshal.SizeOf(typeof(NativeBody)));
            body.Material = Material; body.Bus = Bus; body.Gain = Gain; body.Name = pins.Of(Name); body.Stock = pins.Of(Stock); body.SizeM = SizeM;
            body.Modes = pins.Of(Modes); body.ModeCount = (uint)(Modes == null ? 0 : Modes.Length); body.ImpulseNS = ImpulseNS;
            body.ModesJson = pins.Of(ModesJson); body.Table = pins.Of(Table); body.Files = pins.Of(Files); body.StrikeGain = StrikeGain;
            return body;
        }
    }

    /// <summary>A surface that is touched. NaN = not told. Heights are rows of Width samples, ReliefM high at full scale (floats: times ReliefM).</summary>
    public sealed class Surface
    {
        public string Name, Table;
        public ulong Body;
        public Wrap Wrap;
        public double WidthM, HeightM, ReliefM = double.NaN, Roughness = double.NaN, MicroReliefM = double.NaN, Friction = double.NaN,
            ComplianceMN = double.NaN;
        public Array Heights, RoughnessMap;
        public uint HeightsWidth, HeightsChannels = 1, RoughnessWidth, RoughnessChannels = 1;
        /// <summary>Where files lie that Table names; null = the disk.</summary>
        public Func<string, byte[]> Files;

        static NativeImage Image(Pins pins, Array samples, uint width, uint channels)
        {
            var image = new NativeImage { Channels = 1 };
            if (samples == null) return image;
            image.Samples = pins.Of((object)samples);
            image.Format = samples is byte[] ? Format.U8 : samples is ushort[] ? Format.U16 : Format.F32;
            image.Width = width; image.Channels = channels;
            image.Height = width * channels == 0 ? 0 : (uint)samples.Length / (width * channels);
            if (!(samples is byte[] || samples is ushort[] || samples is float[]))
                throw new ArgumentException("samples: must be byte[], ushort[] or float[]");
            return image;
        }

        internal NativeSurface Native(Pins pins)
        {
            NativeSurface surface;
            Asperity.Native.asp_surface_init(out surface);
            surface.Wrap = Wrap; surface.Body = Body; surface.Name = pins.Of(Name); surface.WidthM = WidthM; surface.HeightM = HeightM;
            surface.ReliefM = ReliefM; surface.Roughness = Roughness; surface.MicroReliefM = MicroReliefM; surface.Friction = Friction;
            surface.ComplianceMN = ComplianceMN; surface.Table = pins.Of(Table); surface.Files = pins.Of(Files);
            surface.Heights = Image(pins, Heights, HeightsWidth, HeightsChannels);
            surface.RoughnessMap = Image(pins, RoughnessMap, RoughnessWidth, RoughnessChannels);
            return surface;
        }
    }

    /// <summary>The game's half of an engine.</summary>
    public sealed class Scene : IDisposable
    {
        IntPtr handle;
        internal IntPtr Handle { get { return handle; } }

        Scene(IntPtr handle) { this.handle = handle; }

        /// <summary>Builds an engine; the renderer is for the audio thread.</summary>
        public static Scene Build(out Renderer renderer, double sampleRateHz = 0, uint hapticChannels = 0, uint audioBuses = 0, Clock clock = Clock.Live,
                                  string more = null)
        {
            Native.Check();
            using (var pins = new Pins())
            {
                NativeConfig config;
                Native.asp_config_init(out config);
                config.Clock = clock; config.SampleRateHz = sampleRateHz; config.HapticChannels = hapticChannels; config.AudioBuses = audioBuses;
                config.More = pins.Of(more);
                IntPtr scene, audio;
                Native.Must(Native.asp_build(ref config, out scene, out audio));
                renderer = new Renderer(audio);
                return new Scene(scene);
            }
        }

        /// <summary>The engine of a scene file; with text, that is the scene, and path says where its files lie. `files` answers with the bytes of a
        /// file, or null where there is none, for a program that keeps them in an archive; null = the disk.</summary>
        public static Scene Load(string path, out Renderer renderer, string text = null, double sampleRateHz = 0, Clock clock = Clock.Live,
                                 Func<string, byte[]> files = null)
        {
            Native.Check();
            using (var pins = new Pins())
            {
                NativeConfig config;
                Native.asp_config_init(out config);
                config.Clock = clock; config.SampleRateHz = sampleRateHz;
                IntPtr scene, audio;
                pins.Must(Native.asp_load(Native.Bytes(path), Native.Bytes(text), pins.Of(files), ref config, out scene, out audio));
                renderer = new Renderer(audio);
                return new Scene(scene);
            }
        }

        public ulong Find(Kind kind, string name)
        {
            ulong id;
            Native.Must(Native.asp_find(handle, kind, Native.Bytes(name), out id));
            return id;
        }

        public ulong Add(Body body)
        {
            using (var pins = new Pins())
            {
                var native = body.Native(pins);
                ulong id;
                pins.Must(Native.asp_add_body(handle, ref native, out id));
                return id;
            }
        }

        public ulong Add(Surface surface)
        {
            using (var pins = new Pins())
            {
                var native = surface.Native(pins);
                ulong id;
                pins.Must(Native.asp_add_surface(handle, ref native, out id));
                return id;
            }
        }

        public void Replace(ulong id, Body body)
        {
            using (var pins = new Pins())
            {
                var native = body.Native(pins);
                pins.Must(Native.asp_replace_body(handle, id, ref native));
            }
        }

        public void Replace(ulong id, Surface surface)
        {
            using (var pins = new Pins())
            {
                var native = surface.Native(pins);
                pins.Must(Native.asp_replace_surface(handle, id, ref native));
            }
        }

        public ulong AddProbe(string table, string name = null)
        {
            ulong id;
            Native.Must(Native.asp_add_probe(handle, Native.Bytes(table), Native.Bytes(name), out id));
            return id;
        }

        public void RemoveBody(ulong id) { Native.Must(Native.asp_remove_body(handle, id)); }
        public void RemoveSurface(ulong id) { Native.Must(Native.asp_remove_surface(handle, id)); }

        /// <summary>One call a physics step. How many of the events were taken; what was refused is counted in Stats, the first in `refusal`.</summary>
        public uint Report(double timeS, Event[] events, int count, out string refusal)
        {
            if (count < 0 || count > events.Length) throw new ArgumentOutOfRangeException("count");
            uint taken;
            int status = Native.asp_report(handle, timeS, events, (uint)count, (uint)Marshal.SizeOf(typeof(Event)), out taken);
            refusal = status == 0 ? null : Native.Text(Native.asp_last_error());
            return taken;
        }

        /// <summary>The same; a refusal is an exception.</summary>
        public void Report(double timeS, params Event[] events)
        {
            uint taken;
            Native.Must(Native.asp_report(handle, timeS, events, (uint)events.Length, (uint)Marshal.SizeOf(typeof(Event)), out taken));
        }

        public void SetBodyGain(ulong id, double gain) { Native.Must(Native.asp_set_body_gain(handle, id, gain)); }
        /// <summary>Lets a body sound on a bus beside its own, so loud; 0 for no longer. At most four: a bus for each listener.</summary>
        public void SetBodySend(ulong id, uint bus, double gain) { Native.Must(Native.asp_set_body_send(handle, id, bus, gain)); }
        public void SetBodyBus(ulong id, uint bus) { Native.Must(Native.asp_set_body_bus(handle, id, bus)); }
        public void SetBusGain(uint bus, double gain) { Native.Must(Native.asp_set_bus_gain(handle, bus, gain)); }
        public void SetHapticGain(uint channel, double gain) { Native.Must(Native.asp_set_haptic_gain(handle, channel, gain)); }
        public void SetMuted(bool muted) { Native.Must(Native.asp_set_muted(handle, muted ? 1u : 0u)); }
        public void SetPaused(bool paused) { Native.Must(Native.asp_set_paused(handle, paused ? 1u : 0u)); }
        /// <summary>Game seconds a second of audio; with bendPitch (0.1 to 2) all that is heard and felt bends with it.</summary>
        public void SetTimeScale(double scale, bool bendPitch = false)
        {
            Native.Must(bendPitch ? Native.asp_bend_time(handle, scale) : Native.asp_set_time_scale(handle, scale));
        }

        /// <summary>A strike with a name, for games that roll back: reported again, it still sounds once.</summary>
        public void ReportNamed(double timeS, ulong name, Event strike)
        {
            Native.Must(Native.asp_report_named(handle, timeS, name, ref strike, (uint)Marshal.SizeOf(typeof(Event))));
        }

        /// <summary>Plays a waveform on a haptic channel beside strokes, which have the gain ducking (0 to 1) meanwhile.</summary>
        public void PlayClip(double timeS, uint channel, float[] samples, double rateHz, double gain = 1.0, double ducking = 1.0)
        {
            Native.Must(Native.asp_play_clip(handle, timeS, channel, samples, (uint)samples.Length, rateHz, gain, ducking));
        }

        /// <summary>Takes a strike with a name back; true where it waited and does not sound.</summary>
        public bool Withdraw(ulong name)
        {
            uint waited;
            Native.Must(Native.asp_withdraw(handle, name, out waited));
            return waited != 0;
        }

        public void FadeAll() { Native.Must(Native.asp_fade_all(handle)); }
        public void Reset() { Native.Must(Native.asp_reset(handle)); }
        public void StartRecording() { Native.Must(Native.asp_record_start(handle)); }
        public void StopRecording(string path) { Native.Must(Native.asp_record_stop(handle, Native.Bytes(path))); }

        /// <summary>A level in use: of a haptic channel, a bus, or the id of a body.</summary>
        public double LevelOf(Level kind, ulong of)
        {
            double level;
            Native.Must(Native.asp_get_level(handle, kind, of, out level));
            return level;
        }

        public Stats Stats()
        {
            var stats = new Stats { StructSize = (uint)Marshal.SizeOf(typeof(Stats)) };
            Native.Must(Native.asp_get_stats(handle, ref stats));
            return stats;
        }

        /// <summary>What speaks against anything being heard or felt, a line a reason; empty when nothing does.</summary>
        public string WhySilent() { return Why(Native.asp_why_silent); }

        /// <summary>What leaves more than full scale holds, by how much, and what to turn, a line a reason; empty when nothing does.</summary>
        public string WhyClipped() { return Why(Native.asp_why_clipped); }

        string Why(Func<IntPtr, byte[], uint, int> told)
        {
            var room = new byte[4096];
            Native.Must(told(handle, room, (uint)room.Length));
            return Encoding.UTF8.GetString(room, 0, Array.IndexOf<byte>(room, 0));
        }

        /// <summary>A tracked tip over surfaces that have a frame (in their Table); NaN = 200 N/m, 0.1 kg, 5 N.</summary>
        public Tip Track(ulong[] surfaces, double stiffnessNM = double.NaN, double massKg = double.NaN, double maxForceN = double.NaN)
        {
            IntPtr tip;
            Native.Must(Native.asp_tip_new(handle, surfaces, (uint)surfaces.Length, stiffnessNM, massKg, maxForceN, out tip));
            return new Tip(tip);
        }

        public Port Open(PortKind kind, Feed feed = Feed.Haptic, uint index = 0, double rateHz = 100, double holdsS = 0.1)
        {
            NativePortConfig config;
            Native.asp_port_config_init(out config);
            config.Kind = kind; config.Feed = feed; config.Index = index; config.RateHz = rateHz; config.HoldsS = holdsS;
            IntPtr port;
            Native.Must(Native.asp_open_port(handle, ref config, out port));
            return new Port(port);
        }

        public void Dispose()
        {
            Native.asp_scene_free(handle);
            handle = IntPtr.Zero;
            GC.SuppressFinalize(this);
        }

        ~Scene() { Native.asp_scene_free(handle); }
    }

    /// <summary>The audio thread's half. Haptic channels are Renderer.Haptic + i in a map, audio buses 0, 1, ...</summary>
    public sealed class Renderer : IDisposable
    {
        public const int Silent = -1, Haptic = 1000;
        IntPtr handle;

        internal Renderer(IntPtr handle) { this.handle = handle; }

        /// <summary>The next samples, interleaved: what a map's channel carries goes there; null: buses on channels 0 and 1, then haptic channels.</summary>
        public void Render(float[] samples, int channels, int[] map = null)
        {
            if (channels <= 0 || map != null && map.Length < channels) return;
            Native.asp_render_interleaved(handle, samples, (uint)channels, (uint)(samples.Length / channels), map);
        }

        public void ReportLoad(float load) { Native.asp_report_load(handle, load); }

        public void Signals(out uint haptics, out uint buses, out double rateHz, out uint latencySamples)
        {
            Native.Must(Native.asp_signals(handle, out haptics, out buses, out rateHz, out latencySamples));
        }

        /// <summary>The engine goes on at another rate, while nobody renders.</summary>
        public void SetSampleRate(Scene scene, double rateHz) { Native.Must(Native.asp_set_sample_rate(scene.Handle, handle, rateHz)); }

        /// <summary>The value of the mixer effect's parameter "Engine".</summary>
        public uint UnitySlot()
        {
            uint slot;
            Native.Must(Native.asp_unity_slot(handle, out slot));
            return slot;
        }

        public void Dispose()
        {
            Native.asp_renderer_free(handle);
            handle = IntPtr.Zero;
            GC.SuppressFinalize(this);
        }

        ~Renderer() { Native.asp_renderer_free(handle); }
    }

    /// <summary>A tracked tip: the pose of a fingertip becomes an event for Scene.Report.</summary>
    public sealed class Tip : IDisposable
    {
        IntPtr handle;
        readonly double[] position = new double[3];
        internal Tip(IntPtr handle) { this.handle = handle; }
        /// <summary>At x, y, z (m, in the axes of the surfaces' body), dtS after the last step. False where nothing is touched.</summary>
        public bool Step(double dtS, double x, double y, double z, ulong contact, int actuator, out Event e)
        {
            position[0] = x; position[1] = y; position[2] = z;
            e = Event.New();
            Native.Must(Native.asp_tip_step(handle, dtS, position, contact, actuator, ref e));
            return e.Kind != 0;
        }
        /// <summary>The game has moved the hand elsewhere. False where nothing was touched.</summary>
        public bool Lift(ulong contact, out Event e)
        {
            e = Event.New();
            Native.Must(Native.asp_tip_lift(handle, contact, ref e));
            return e.Kind != 0;
        }
        public void Dispose()
        {
            Native.asp_tip_free(handle);
            handle = IntPtr.Zero;
            GC.SuppressFinalize(this);
        }
        ~Tip() { Native.asp_tip_free(handle); }
    }

    /// <summary>What leaves the engine, for any one thread.</summary>
    public sealed class Port : IDisposable
    {
        IntPtr handle;
        internal Port(IntPtr handle) { this.handle = handle; }
        public int Pcm(float[] samples) { return (int)Native.asp_port_pcm(handle, samples, (uint)samples.Length); }
        public int Points(Point[] points) { return (int)Native.asp_port_points(handle, points, (uint)points.Length); }
        public int Forces(Force[] forces) { return (int)Native.asp_port_forces(handle, forces, (uint)forces.Length); }
        public void Levels(out double heavy, out double light) { Native.asp_port_levels(handle, out heavy, out light); }
        public ulong Lost { get { return Native.asp_port_lost(handle); } }
        public void Dispose()
        {
            Native.asp_port_free(handle);
            handle = IntPtr.Zero;
            GC.SuppressFinalize(this);
        }
        ~Port() { Native.asp_port_free(handle); }
    }
}
