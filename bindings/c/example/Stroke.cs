// A plate is struck and stroked for a second; what is heard and felt is measured.
using System;
using Asperity;

static class Stroke
{
    static int Main()
    {
        Renderer renderer;
        // Rendered here and now; a game that runs keeps the default, Clock.Live, and renders on its audio thread.
        using (var scene = Scene.Build(out renderer, sampleRateHz: 48000, clock: Clock.Exact))
        {
            ulong plate = scene.Add(new Body { Stock = "plate", SizeM = 0.14, Material = Material.Ceramic });
            ulong top = scene.Add(new Surface { WidthM = 0.14, HeightM = 0.14, Body = plate, Table = "solid = \"granite\"" });
            var block = new float[2 * 800];
            double heard = 0, felt = 0;
            for (int tick = 0; tick < 60; tick++)
            {
                double t = tick / 60.0, u = 0.1 + 0.7 * t;
                scene.Report(t, tick == 0 ? Event.Begin(1, top, 0, u, 0.5, 0.6) : Event.Move(1, u, 0.5, 0.6));
                if (tick == 20) scene.Report(t, Event.Collision(plate, 0.002, 0.5, 0.6));
                renderer.Render(block, 2, new[] { 0, Renderer.Haptic });
                for (int i = 0; i < 800; i++)
                {
                    heard = Math.Max(heard, Math.Abs(block[2 * i]));
                    felt = Math.Max(felt, Math.Abs(block[2 * i + 1]));
                }
            }
            Console.WriteLine("heard {0:g3}, felt {1:g3}. {2}", heard, felt, scene.WhySilent());
            renderer.Dispose();
            return heard > 0 && felt > 0 ? 0 : 1;
        }
    }
}
