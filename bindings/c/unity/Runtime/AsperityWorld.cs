// The engine of a scene: builds it at Unity's rate, reports once a physics step, and plays it: where its own object is heard, or, given a mixer,
// through that mixer's effect "Asperity".
using System.Collections.Generic;
using UnityEngine;
using UnityEngine.Audio;

namespace Asperity
{
    /// <summary>Origin of the levels of bodies and surfaces that are added.</summary>
    public enum LevelPolicy { AsGiven, Shared, Each }

    [DefaultExecutionOrder(-1000)]
    public sealed class AsperityWorld : MonoBehaviour
    {
        [Tooltip("None: played from this object. Else a mixer whose group carries the effect Asperity, with its parameter Engine exposed")]
        public AudioMixer Mixer;
        [Tooltip("The name under which the parameter Engine is exposed")]
        public string EngineParameter = "AsperityEngine";
        [Tooltip("Levels of what is added: found by trials and shared, found for each thing, or as its numbers say")]
        public LevelPolicy Levels = LevelPolicy.Shared;
        [Tooltip("Loudness before the limiter; without levels that are found, blows of a physics engine reach many times full scale")]
        public float Gain = 1f;
        [Tooltip("Haptic channels: hands, controllers")]
        public uint HapticChannels = 2;

        public static AsperityWorld Current { get; private set; }
        public Scene Scene { get; private set; }
        public Renderer Renderer { get; private set; }

        Event[] events = new Event[64];
        int count;
        string lastRefusal;
        float[] block = new float[0];
        int[] map = new int[0];

        void OnEnable()
        {
            Renderer renderer;
            string audio = "audio = [{ gain = " + Gain.ToString("R", System.Globalization.CultureInfo.InvariantCulture) + ", limit = true }]\n";
            // What is felt is limited as well: a blow moves a fingertip by millimetres, and full scale is a tenth of one.
            var channels = new string[System.Math.Min(System.Math.Max(1u, HapticChannels), 64u)];
            for (int channel = 0; channel < channels.Length; channel++) channels[channel] = "{ limit_peaks = true }";
            string haptics = "actuators = [" + string.Join(", ", channels) + "]\n";
            string levels = "levels = \"" + (Levels == LevelPolicy.AsGiven ? "as-given" : Levels.ToString().ToLowerInvariant()) + "\"\n";
            Scene = Scene.Build(out renderer, AudioSettings.outputSampleRate, HapticChannels, more: levels + audio + haptics);
            Renderer = renderer;
            Current = this;
            if (Physics.gravity.magnitude > 100f)
                Debug.LogWarning("Asperity: gravity is " + Physics.gravity.magnitude + "; asperity takes metres: scale the physics");
            // Unity hears an object only where one of these is on it.
            if (Mixer == null && GetComponent<AudioSource>() == null && GetComponent<AudioListener>() == null) gameObject.AddComponent<AudioSource>();
            if (Mixer != null && !Mixer.SetFloat(EngineParameter, renderer.UnitySlot()))
                Debug.LogWarning("Asperity: the mixer exposes no parameter \"" + EngineParameter + "\"; expose the effect's Engine under this name");
        }

        /// <summary>Keeps an event until the end of the physics step.</summary>
        public void Report(Event e)
        {
            if (count == events.Length) System.Array.Resize(ref events, 2 * count);
            events[count++] = e;
        }

        void FixedUpdate()
        {
            if (Scene == null) return;
            string refusal;
            Scene.Report(Time.fixedTimeAsDouble, events, count, out refusal);
            count = 0;
            // Each kind of mistake once, not sixty times a second.
            if (refusal != null && refusal != lastRefusal) Debug.LogWarning("Asperity: " + refusal);
            lastRefusal = refusal ?? lastRefusal;
        }

        // Audio thread. Without a mixer the bus is added to what this object plays; haptic channels leave by ports.
        void OnAudioFilterRead(float[] samples, int channels)
        {
            var renderer = Renderer;
            if (Mixer != null || renderer == null || channels <= 0) return;
            if (block.Length != samples.Length || map.Length != channels)
            {
                block = new float[samples.Length];
                map = new int[channels];
                for (int channel = 2; channel < channels; channel++) map[channel] = Renderer.Silent;
            }
            renderer.Render(block, channels, map);
            for (int i = 0; i < samples.Length; i++) samples[i] += block[i];
        }

        void OnDisable()
        {
            if (Mixer != null) Mixer.SetFloat(EngineParameter, 0f);
            if (Renderer != null) Renderer.Dispose();
            if (Scene != null) Scene.Dispose();
            Renderer = null;
            Scene = null;
            count = 0;
            if (Current == this) Current = null;
        }
    }
}
