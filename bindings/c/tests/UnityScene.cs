// The components and the sample, driven as Unity drives them: a second of physics steps, each with a block of audio.
using System;
using System.Collections.Generic;
using System.Globalization;
using Asperity;
using UnityEngine;

static class UnityScene
{
    static void Must(bool holds, string what)
    {
        if (holds) return;
        Console.Error.WriteLine("does not hold: " + what + "; warned: " + Debug.Warned);
        Environment.Exit(1);
    }

    /// <summary>Energy of the second that was rendered last.</summary>
    static double energy;

    static float Second(Action<int> between)
    {
        float peak = 0f;
        energy = 0;
        for (int step = 0; step < 50; step++)
        {
            Time.fixedTimeAsDouble += 0.02;
            between(step);
            Messages.SendAll("FixedUpdate");
            var block = new float[2 * 960];
            Messages.SendAll("OnAudioFilterRead", block, 2);
            foreach (var x in block) { peak = Math.Max(peak, Math.Abs(x)); energy += (double)x * x; }
            Messages.SendAll("Update");
            Messages.SendAll("OnGUI");
        }
        return peak;
    }

    /// <summary>Modes of a plate of 1 m by 2 cm by 1 m whose upper face moves as cosines, in its own frame.</summary>
    static string ShapedPlate()
    {
        const int side = 17;
        Func<double, string> number = x => x.ToString("R", CultureInfo.InvariantCulture);
        var points = new List<string>();
        var triangles = new List<string>();
        var modes = new List<string>();
        var gains = new List<string>();
        var motions = new List<string>();
        for (int i = 0; i < side * side; i++)
        {
            points.Add("[" + number(i / side / 16.0 - 0.5) + ",0.01," + number(i % side / 16.0 - 0.5) + "]");
            if (i % side == side - 1 || i / side == side - 1) continue;
            triangles.Add("[" + i + "," + (i + 1) + "," + (i + side) + "]");
            triangles.Add("[" + (i + 1) + "," + (i + side + 1) + "," + (i + side) + "]");
        }
        foreach (var order in new[] { new[] { 1, 0 }, new[] { 0, 2 }, new[] { 1, 1 }, new[] { 2, 2 }, new[] { 3, 1 } })
        {
            var moves = new List<string>();
            for (int i = 0; i < side * side; i++)
                moves.Add("[0," + number(Math.Cos(Math.PI * order[0] * (i / side) / 16) * Math.Cos(Math.PI * order[1] * (i % side) / 16)) + ",0]");
            modes.Add("{\"frequency_hz\":" + (300 + 210 * modes.Count) + ",\"decay_per_s\":20,\"amplitude\":1}");
            gains.Add("1");
            motions.Add("[" + string.Join(",", moves) + "]");
        }
        return "{\"format\":\"asperity.modes\",\"version\":2,\"unit\":\"relative\",\"modes\":[" + string.Join(",", modes) +
            "],\"shapes\":{\"points_m\":[" + string.Join(",", points) + "],\"triangles\":[" + string.Join(",", triangles) + "],\"gains\":[" +
            string.Join(",", gains) + "],\"phi_per_sqrt_kg\":[" + string.Join(",", motions) + "],\"struck_point\":0}}";
    }

    /// <summary>A plate on end, struck in the middle, at an edge and at a corner, sounds as it does with its place told by hand.</summary>
    static void StruckPlaces(AsperityWorld world)
    {
        var on = new GameObject("Plate on end");
        on.transform.position = new Vector3(1, 2, 3);
        on.transform.right = new Vector3(0, 1, 0);
        on.transform.up = new Vector3(-1, 0, 0);
        var plate = on.AddComponent<AsperityBody>();
        plate.ModesJson = new TextAsset(ShapedPlate());
        Messages.Send(plate, "Start");
        var levels = new List<double>();
        foreach (var at in new[] { new Vector3(0, 0.01f, 0), new Vector3(0.4f, 0.01f, 0), new Vector3(0.21f, 0.01f, -0.37f), new Vector3(0.45f, 0.01f, 0.45f) })
        {
            var both = new double[2];
            for (int byHand = 0; byHand < 2; byHand++)
            {
                // In the world its own x points up, and its own y to the left.
                var hits = new Collision { impulse = new Vector3(-0.01f, 0, 0), relativeVelocity = new Vector3(1f, 0, 0), Normal = new Vector3(-1, 0, 0) };
                hits.Point = on.transform.position + new Vector3(-at.y, at.x, at.z);
                var told = Asperity.Event.Collision(plate.Body, 0.01, 1.0, 0.5);
                told.AtX = at.x; told.AtY = at.y; told.AtZ = at.z;
                Second(step =>
                {
                    if (step != 5) return;
                    if (byHand == 0) Messages.Send(plate, "OnCollisionEnter", hits); else world.Report(told);
                });
                both[byHand] = 10 * Math.Log10(energy);
                Second(step => { });
            }
            Console.WriteLine("struck at ({0}, {1}) m: {2:f3} dB, by hand {3:f3}", at.x, at.z, both[0], both[1]);
            Must(Math.Abs(both[0] - both[1]) < 0.1, "a blow sounds as told by hand: " + both[0] + " dB beside " + both[1]);
            levels.Add(both[1]);
        }
        Must(levels[3] - levels[0] > 3, "places differ: " + levels[0] + " and " + levels[3] + " dB");
        Messages.Send(plate, "OnDestroy");
    }

    static void Main()
    {
        new GameObject("Anything").AddComponent<FirstTouch>();
        var world = AsperityWorld.Current;
        Must(world.GetComponent<AudioSource>() != null, "a world without a mixer is heard from its own object");
        Messages.SendAll("Start");
        var plate = GameObject.All.Find(thing => thing.GetComponent<AsperityBody>() != null).GetComponent<AsperityBody>();
        Physics.Ground = plate.GetComponent<Collider>();
        Physics.Top = 0.01f;
        float stroked = Second(step => { });
        Must(stroked > 1e-5f && !GUI.Said.StartsWith("felt: 0.0000"), "a stroke is heard and felt: " + stroked + ", " + GUI.Said);
        var blow = new Collision { impulse = new Vector3(0, 0.5f, 0), relativeVelocity = new Vector3(0, -2f, 0) };
        float struck = Second(step => { if (step == 5) Messages.Send(plate, "OnCollisionEnter", blow); });
        Must(struck > 2f * stroked && struck <= 1f, "a blow is heard: " + struck + " beside " + stroked);
        Must(world.Scene.Stats().Impacts == 1 && world.Scene.Stats().Refused == 0 && Debug.Warned == "", "nothing is refused");
        var port = world.Scene.Open(PortKind.Pcm, Feed.Haptic, 1, holdsS: 2.0);
        var tapped = Asperity.Event.Impact(plate.Body, 1.0, 0.02, 0.005);
        tapped.Actuator = 1;
        Second(step => { if (step == 5) world.Report(tapped); });
        var felt = new float[96000];
        port.Pcm(felt);
        port.Dispose();
        float most = 0f;
        foreach (var x in felt) most = Math.Max(most, Math.Abs(x));
        Must(most > 0.5f && most <= 1f, "a blow that a finger feels stays within full scale: " + most);

        // The same blow on a controller and on a pad: they vibrate, stop, and go on where they were unplugged.
        var haptics = new GameObject("Hand").AddComponent<AsperityHaptics>();
        haptics.HapticChannel = 1;
        float motors = 0f, last = 1f;
        haptics.Motors.AddListener((heavy, light) => { last = Math.Max(heavy, light); motors = Math.Max(motors, last); });
        for (int plugged = 0; plugged < 3; plugged++)
        {
            UnityEngine.XR.InputDevice.Connected = plugged != 1;
            UnityEngine.XR.InputDevice.Amplitudes.Clear();
            Second(step => { if (step == 5) world.Report(tapped); });
            Second(step => { });
            var told = UnityEngine.XR.InputDevice.Amplitudes;
            Must((told.Count > 0) == (plugged != 1) && UnityEngine.XR.InputDevice.Wrong == 0, "a controller that is there vibrates: " + told.Count);
            Must(motors > 0.05f && motors <= 1f && last == 0f, "motors turn and stop: " + motors + ", " + last);
        }
        Must(UnityEngine.XR.InputDevice.Stops >= 2, "a controller stops");
        Messages.Send(haptics, "OnDisable");
        haptics.gameObject.Components.Clear();

        // A ball of 2 cm that slides over the plate at 0.5 m/s, and one that rolls: softer, and each ends where it leaves.
        Physics.Ground = null;
        Second(step => { });
        var moving = new GameObject("Marble");
        var marble = moving.AddComponent<Rigidbody>();
        var slider = moving.AddComponent<AsperitySlider>();
        var heard = new float[2];
        for (int rolls = 0; rolls < 2; rolls++)
        {
            slider.RollRadiusM = 0.01f;
            marble.Velocity = new Vector3(0.5f, 0, 0);
            marble.Spin = new Vector3(0, 0, -50f * rolls);
            var on = new Collision { collider = plate.GetComponent<Collider>(), impulse = new Vector3(0, 0.02f, 0) };
            heard[rolls] = Second(step =>
            {
                on.Point = new Vector3(0.01f * step, 0.01f, 0);
                marble.Centre = on.Point + new Vector3(0, 0.01f, 0);
                Messages.Send(slider, "OnCollisionStay", on);
            });
            Must(world.Scene.Stats().Contacts == 1, "it touches");
            Messages.Send(slider, "OnCollisionExit", on);
            Second(step => { });
            Must(world.Scene.Stats().Contacts == 0, "it has left");
        }
        Must(heard[1] > 1e-6f && heard[1] < 0.7f * heard[0], "what rolls is softer than what slides: " + heard[1] + " beside " + heard[0]);
        Must(world.Scene.Stats().Refused == 0 && Debug.Warned == "", "nothing is refused");

        // Down its side it scrapes as over its top, and what rides on a belt is silent.
        var crate = new GameObject("Crate").AddComponent<Rigidbody>();
        var box = crate.gameObject.AddComponent<AsperitySlider>();
        Func<Vector3, Vector3, float> slides = (along, normal) =>
        {
            crate.Velocity = along;
            var on = new Collision { collider = plate.GetComponent<Collider>(), impulse = new Vector3(0, 0.02f, 0), Normal = normal };
            float peak = Second(step =>
            {
                on.Point = along * (0.02f * step);
                crate.Centre = on.Point;
                Messages.Send(box, "OnCollisionStay", on);
            });
            Messages.Send(box, "OnCollisionExit", on);
            Second(step => { });
            return peak;
        };
        float above = slides(new Vector3(0.5f, 0, 0), new Vector3(0, 1, 0));
        float down = slides(new Vector3(0, -0.5f, 0), new Vector3(1, 0, 0));
        Must(down > 0.7f * above && down < 1.4f * above, "a side is a surface: " + down + " beside " + above);
        plate.BeltMS = new Vector3(0.5f, 0, 0);
        float ridden = slides(new Vector3(0.5f, 0, 0), new Vector3(0, 1, 0));
        Must(ridden < 0.01f * above, "what rides on a belt is silent: " + ridden + " beside " + above);
        plate.BeltMS = new Vector3();
        StruckPlaces(world);
        Must(world.Scene.Stats().Refused == 0 && Debug.Warned == "", "nothing is refused");
        Physics.Ground = plate.GetComponent<Collider>();

        // With a mixer the world leaves its own object silent and tells the effect which engine is its.
        var mixer = new UnityEngine.Audio.AudioMixer();
        mixer.Exposed["AsperityEngine"] = 0f;
        Messages.Send(world, "OnDisable");
        Must(AsperityWorld.Current == null, "a world that is disabled is gone");
        world.Mixer = mixer;
        Messages.Send(world, "OnEnable");
        Must(mixer.Exposed["AsperityEngine"] == world.Renderer.UnitySlot() && Second(step => { }) == 0f, "the mixer plays it");
        // Bodies and fingers join the new engine by themselves.
        Messages.Send(world, "OnDisable");
        world.Mixer = null;
        Messages.Send(world, "OnEnable");
        struck = Second(step => { if (step == 5) Messages.Send(plate, "OnCollisionEnter", blow); });
        Must(struck > 2f * stroked && world.Scene.Stats().Impacts == 1 && world.Scene.Stats().Refused == 0 && Debug.Warned == "", "an engine enabled again sounds as before");
        world.Mixer = mixer;
        Messages.Send(world, "OnDisable");
        world.EngineParameter = "Other";
        Messages.Send(world, "OnEnable");
        Must(Debug.Warned.Contains("exposes no parameter \"Other\""), "a parameter that is not exposed is told");
        Messages.SendAll("OnDestroy");
        Messages.SendAll("OnDisable");
        Must(AsperityWorld.Current == null, "all is gone");
        Console.WriteLine("Unity's components: a stroke is heard and felt ({0:g3}), a blow rings ({1:g3})", stroked, struck);
    }
}
