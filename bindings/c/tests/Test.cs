// The C# file under Mono: sizes, a stroke, error texts, the garbage collector while another thread renders.
using System;
using System.Collections.Generic;
using System.Runtime.InteropServices;
using System.Threading;
using Asperity;

static class Test
{
    static void Must(bool holds, string what)
    {
        if (holds) return;
        Console.Error.WriteLine("does not hold: " + what);
        Environment.Exit(1);
    }

    static void Refused(int status, string word, Action call)
    {
        try { call(); }
        catch (AsperityException refusal)
        {
            Must(refusal.Status == status && refusal.Message.Contains(word), refusal.Status + " \"" + refusal.Message + "\" speaks of " + word);
            return;
        }
        Must(false, "a refusal that speaks of " + word);
    }

    static void Sizes()
    {
        Native.Check();
        foreach (var type in Native.Structs) Must(Marshal.SizeOf(type) % 8 == 0, type + " is aligned");
        var sizes = Array.ConvertAll(Native.Structs, type => (uint)Marshal.SizeOf(type));
        for (int i = 0; i < sizes.Length; i++)
        {
            sizes[i] += 8;
            Refused(-10, "bytes in the header", () => Native.Must(Native.asp_check_abi(1, sizes, (uint)sizes.Length)));
            sizes[i] -= 8;
        }
        // Fields lie where the library has them: defaults that it writes are found again.
        var e = Event.New();
        Must(e.Actuator == -1 && double.IsNaN(e.U) && double.IsNaN(e.Importance) && e.MassKg == 0.004 && e.RadiusM == 0.005 && e.Restitution == 1 &&
             double.IsNaN(e.StrikerDensityKgM3) && double.IsNaN(e.SlipMS) && double.IsNaN(e.RollRadiusM), "the fields of an event");
        NativeSurface s;
        Native.asp_surface_init(out s);
        Must(double.IsNaN(s.WidthM) && s.RoughnessMap.Channels == 1 && double.IsNaN(s.ComplianceMN) && s.Table == IntPtr.Zero, "the fields of a surface");
        NativePortConfig p;
        Native.asp_port_config_init(out p);
        Must(p.Kind == PortKind.Pcm && p.HighHz == 200 && p.Strongest == 0, "the fields of a port");
    }

    static double Stroke()
    {
        Renderer renderer;
        using (var scene = Scene.Build(out renderer, 48000, 2, 1, Clock.Exact))
        using (renderer)
        {
            ulong plate = scene.Add(new Body { Stock = "plate", SizeM = 0.14, Material = Material.Ceramic, Name = "Teller für Brötchen" });
            Must(scene.Find(Kind.Body, "Teller für Brötchen") == plate, "a name with letters beyond ASCII");
            var heights = new float[64];
            for (int i = 0; i < 64; i++) heights[i] = (float)(2e-5 * Math.Sin(i % 8 * Math.PI / 4));
            ulong top = scene.Add(new Surface { WidthM = 0.004, HeightM = 0.004, ReliefM = 1, Heights = heights, HeightsWidth = 8, Body = plate });
            using (var port = scene.Open(PortKind.Pcm, Feed.Haptic, 1))
            {
                double heard = 0, felt = 0;
                var block = new float[2 * 800];
                var pcm = new float[1000];
                for (int tick = 0; tick < 60; tick++)
                {
                    double t = tick / 60.0, u = 25 * t;
                    scene.Report(t, tick == 0 ? Event.Begin(1, top, 1, u, 0.5, 0.6) : Event.Move(1, u, 0.5, 0.6));
                    if (tick == 50) scene.Report(t, Event.Collision(plate, 0.002, 0.5, 0.6));
                    renderer.Render(block, 2, new[] { 0, Renderer.Haptic + 1 });
                    int read = port.Pcm(pcm);
                    Must(read == 800, "the port holds what was rendered");
                    for (int i = 0; i < 800; i++)
                    {
                        heard = Math.Max(heard, Math.Abs(block[2 * i]));
                        felt = Math.Max(felt, Math.Abs(block[2 * i + 1]));
                        Must(pcm[i] == block[2 * i + 1], "the port gives the samples of the channel");
                    }
                }
                double full, gain, strike;
                full = scene.LevelOf(Level.FullScale, 1); gain = scene.LevelOf(Level.BusGain, 0); strike = scene.LevelOf(Level.StrikeGain, plate);
                Must(full == 1e-4 && gain == 1 && strike == 1, "levels: " + full + ", " + gain + ", " + strike);
                ulong soft = scene.Add(new Body { Stock = "bar", SizeM = 0.2, StrikeGain = 0.25 });
                Must(scene.LevelOf(Level.StrikeGain, soft) == 0.25, "a body's own gain of strikes");
                Must(heard > 1e-4 && felt > 1e-4, "the stroke is heard and felt: " + heard + ", " + felt);
                Must(scene.Stats().MicroCollisions > 0 && scene.Stats().Impacts == 1 && scene.WhySilent() == "", scene.WhySilent());
                Must(scene.WhyClipped().StartsWith("impacts on body 0 peak"), scene.WhyClipped());
                string refusal;
                uint taken = scene.Report(2, new[] { Event.Move(1, double.NaN, 0.5, 1), Event.End(1) }, 2, out refusal);
                Must(taken == 1 && refusal.Contains("uv"), refusal);
                return heard;
            }
        }
    }

    static void Errors()
    {
        Renderer renderer;
        Refused(-4, "8000 to 384000", () => Scene.Build(out renderer, 10));
        Refused(-7, "nowhere.toml: no such file", () => Scene.Load("nowhere.toml", out renderer));
        using (var scene = Scene.Build(out renderer))
        {
            Refused(-5, "\"gong\" is unknown", () => scene.Find(Kind.Body, "gong"));
            Refused(-4, "cube", () => scene.Add(new Body { Stock = "cube", SizeM = 1 }));
            Refused(-4, "width_m", () => scene.Add(new Surface { WidthM = -1, HeightM = 1 }));
            Refused(-5, "surface", () => scene.Report(0, Event.Begin(1, 77, 0, 0, 0, 1)));
            scene.Dispose();
            Refused(-2, "scene", () => scene.Reset());
            renderer.Dispose();
            renderer.Render(new float[64], 2);
        }
    }

    /// <summary>Files that a program has somewhere else; what its own function throws comes out of the call, never through the library.</summary>
    static void Files()
    {
        const string modes = "{\"format\":\"asperity.modes\",\"version\":1,\"modes\":[{\"frequency_hz\":400,\"decay_per_s\":3,\"amplitude\":1}]}";
        const string text = "[[body]]\nname = \"bell\"\nmodes = \"bell.modes.json\"\n";
        var asked = new List<string>();
        Func<string, byte[]> archive = path =>
        {
            asked.Add(path);
            GC.Collect();
            if (path.EndsWith("scene.toml")) return System.Text.Encoding.UTF8.GetBytes(text);
            return path.EndsWith("bell.modes.json") ? System.Text.Encoding.UTF8.GetBytes(modes) : null;
        };
        Renderer renderer;
        using (var scene = Scene.Load("packed/scene.toml", out renderer, files: archive))
        using (renderer)
        {
            Must(scene.Find(Kind.Body, "bell") != 0 && asked.Count >= 2, "a scene of an archive");
            ulong again = scene.Add(new Body { Table = "modes = \"bell.modes.json\"", Files = archive });
            Must(again != 0, "a body of an archive");
            Refused(-4, "other.json", () => scene.Add(new Body { Table = "modes = \"other.json\"", Files = archive }));
            try
            {
                scene.Add(new Body { Table = "modes = \"bell.modes.json\"", Files = path => { throw new InvalidOperationException("the archive is shut"); } });
                Must(false, "an exception of the program's own");
            }
            catch (InvalidOperationException own) { Must(own.Message == "the archive is shut", own.Message); }
            Must(scene.Add(new Body { Stock = "bar", SizeM = 0.2 }) != 0, "the scene goes on");
        }
    }

    static volatile bool stop;

    static void GarbageCollector()
    {
        Renderer renderer;
        using (var scene = Scene.Build(out renderer, 48000))
        {
            double peak = 0;
            long blocks = 0;
            var audio = new Thread(() =>
            {
                var block = new float[2 * 128];
                while (!stop)
                {
                    renderer.Render(block, 2);
                    foreach (var x in block) peak = Math.Max(peak, Math.Abs(x));
                    blocks++;
                }
            });
            audio.Start();
            var rubbish = new List<byte[]>();
            for (int round = 0; round < 150; round++)
            {
                ulong body = scene.Add(new Body { Stock = "bar", SizeM = 0.2, Material = Material.Steel, Name = "bar " + round });
                scene.Report(round * 0.01, Event.Impact(body, 1, 0.01, 0.005));
                for (int i = 0; i < 50; i++) rubbish.Add(new byte[1000 + i]);
                if (round % 10 == 0) rubbish.Clear();
                // A renderer and scene that nobody holds are freed by their finalizers.
                Renderer lost;
                Scene.Build(out lost);
                GC.Collect();
                Thread.Sleep(1);
                scene.RemoveBody(body);
            }
            GC.Collect();
            GC.WaitForPendingFinalizers();
            stop = true;
            audio.Join();
            Must(peak > 0 && blocks > 100, "the audio thread rendered: " + blocks + " blocks");
            renderer.Dispose();
        }
    }

    static void Main()
    {
        Sizes();
        double heard = Stroke();
        Must(Stroke() == heard, "the same stroke has the same bits");
        Errors();
        Files();
        GarbageCollector();
        Console.WriteLine("C#: sizes, stroke, errors, files and garbage collector hold");
    }
}
