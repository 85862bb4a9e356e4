// A plate is stroked for two seconds and struck; what is heard (left) and felt (right) becomes stroke.wav.
using System;
using System.IO;
using System.Text;
using Asperity;

static class Stroke
{
    const int Rate = 48000, Ticks = 120, Frames = Rate / 60;

    static int Main()
    {
        Renderer renderer;
        // Strokes are soft beside blows, which a limiter keeps within full scale. Rendered here and now; a game that runs keeps the default,
        // Clock.Live, and renders on its audio thread.
        const string Levels = "audio = [{ gain = 0.2, limit = true }]\nactuators = [{ limit_peaks = true }]";
        using (var scene = Scene.Build(out renderer, sampleRateHz: Rate, clock: Clock.Exact, more: Levels))
        using (var wav = new BinaryWriter(File.Create("stroke.wav"), Encoding.ASCII))
        {
            ulong plate = scene.Add(new Body { Stock = "plate", SizeM = 0.14, Material = Material.Ceramic });
            ulong top = scene.Add(new Surface { WidthM = 0.14, HeightM = 0.14, Body = plate, Table = "solid = \"granite\"" });
            Begin(wav, 4 * 2 * Frames * Ticks);
            var block = new float[2 * Frames];
            double heard = 0, felt = 0;
            for (int tick = 0; tick < Ticks; tick++)
            {
                double t = tick / 60.0, u = 0.5 + 0.3 * Math.Sin(2 * t);
                scene.Report(t, tick == 0 ? Event.Begin(1, top, 0, u, 0.5, 0.6) : Event.Move(1, u, 0.5, 0.6));
                if (tick == 90) scene.Report(t, Event.Collision(plate, 0.002, 0.5, 0.6));
                renderer.Render(block, 2, new[] { 0, Renderer.Haptic });
                for (int i = 0; i < Frames; i++)
                {
                    heard = Math.Max(heard, Math.Abs(block[2 * i]));
                    felt = Math.Max(felt, Math.Abs(block[2 * i + 1]));
                }
                foreach (float sample in block) wav.Write(sample);
            }
            Console.WriteLine("stroke.wav is written: heard {0:g3}, felt {1:g3}. {2}", heard, felt, scene.WhySilent());
            renderer.Dispose();
            return heard > 0 && felt > 0 ? 0 : 1;
        }
    }

    // The head of a WAV file of two channels of 32-bit floats.
    static void Begin(BinaryWriter wav, int bytes)
    {
        wav.Write("RIFF".ToCharArray()); wav.Write(36 + bytes); wav.Write("WAVEfmt ".ToCharArray()); wav.Write(16);
        wav.Write((short)3); wav.Write((short)2); wav.Write(Rate); wav.Write(8 * Rate); wav.Write((short)8); wav.Write((short)32);
        wav.Write("data".ToCharArray()); wav.Write(bytes);
    }
}
