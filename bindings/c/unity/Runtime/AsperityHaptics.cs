// What a haptic channel feels, on the controller of a headset (OpenXR and every other provider of Unity's XR) and on the motors of a pad.
using System;
using UnityEngine;
using UnityEngine.Events;
using UnityEngine.XR;

namespace Asperity
{
    public sealed class AsperityHaptics : MonoBehaviour
    {
        /// <summary>Levels of a heavy and a light motor, 0 to 1.</summary>
        [Serializable]
        public sealed class MotorEvent : UnityEvent<float, float> { }

        [Tooltip("Which haptic channel")]
        public int HapticChannel;
        [Tooltip("Sample value that counts as full amplitude")]
        public float FullScale = 1f;
        [Tooltip("Controller of a headset that vibrates")]
        public XRNode Controller = XRNode.RightHand;
        public bool Headset = true;
        [Tooltip("Motors of a pad, each frame while they turn and once when they stop: Gamepad.SetMotorSpeeds of the Input System takes both")]
        public MotorEvent Motors = new MotorEvent();

        /// <summary>Amplitude below which nothing is felt.</summary>
        const float Floor = 1f / 256f;
        /// <summary>Each impulse lasts until the next frames have come, s.</summary>
        const float HeldS = 0.05f;

        Port port;
        Scene scene;
        bool turns;

        void Update()
        {
            var world = AsperityWorld.Current;
            if (world == null || world.Scene == null) return;
            if (world.Scene != scene)
            {
                Close();
                port = world.Scene.Open(PortKind.Levels, Feed.Haptic, (uint)HapticChannel, rateHz: 60);
                scene = world.Scene;
            }
            double heavy, light;
            port.Levels(out heavy, out light);
            float low = Share(heavy), high = Share(light), both = Share(Math.Sqrt(heavy * heavy + light * light));
            bool felt = both >= Floor;
            if (felt || turns) Motors.Invoke(felt ? low : 0f, felt ? high : 0f);
            if (Headset && (felt || turns))
            {
                var device = InputDevices.GetDeviceAtXRNode(Controller);
                if (device.isValid && felt) device.SendHapticImpulse(0u, both, HeldS);
                else if (device.isValid) device.StopHaptics();
            }
            turns = felt;
        }

        float Share(double level) { return (float)Math.Max(0.0, Math.Min(1.0, level / FullScale)); }

        void Close()
        {
            if (port != null) port.Dispose();
            port = null;
        }

        void OnDisable()
        {
            Close();
            scene = null;
            if (!turns) return;
            turns = false;
            Motors.Invoke(0f, 0f);
            var device = InputDevices.GetDeviceAtXRNode(Controller);
            if (Headset && device.isValid) device.StopHaptics();
        }
    }
}
