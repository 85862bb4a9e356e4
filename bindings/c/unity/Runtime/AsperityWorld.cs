// The engine of a scene: builds it at the mixer's rate, reports once a physics step, hands it to the mixer effect "Asperity".
using System.Collections.Generic;
using UnityEngine;
using UnityEngine.Audio;

namespace Asperity
{
    [DefaultExecutionOrder(-1000)]
    public sealed class AsperityWorld : MonoBehaviour
    {
        [Tooltip("A mixer whose group carries the effect Asperity, with its parameter Engine exposed")]
        public AudioMixer Mixer;
        [Tooltip("The name under which the parameter Engine is exposed")]
        public string EngineParameter = "AsperityEngine";
        [Tooltip("Haptic channels: hands, controllers")]
        public uint HapticChannels = 2;

        public static AsperityWorld Current { get; private set; }
        public Scene Scene { get; private set; }
        public Renderer Renderer { get; private set; }

        Event[] events = new Event[64];
        int count;
        string lastRefusal;

        void OnEnable()
        {
            Renderer renderer;
            Scene = Scene.Build(out renderer, AudioSettings.outputSampleRate, HapticChannels);
            Renderer = renderer;
            Current = this;
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

        void OnDisable()
        {
            if (Mixer != null) Mixer.SetFloat(EngineParameter, 0f);
            if (Renderer != null) Renderer.Dispose();
            if (Scene != null) Scene.Dispose();
            Renderer = null;
            Scene = null;
            if (Current == this) Current = null;
        }
    }
}
