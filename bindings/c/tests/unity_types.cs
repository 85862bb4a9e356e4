// The few types of Unity that the components and the sample use, as far as they are needed to run them without it: objects hold their components,
// and Unity's messages are sent by the test.
using System;
using System.Collections.Generic;

namespace UnityEngine
{
    public class Object { }
    public class Component : Object
    {
        public GameObject gameObject;
        public Transform transform { get { return gameObject.transform; } }
        public T GetComponent<T>() where T : Component { return gameObject.GetComponent<T>(); }
    }
    public class Behaviour : Component { }
    public class MonoBehaviour : Behaviour { }
    public class Transform : Component
    {
        public Vector3 position, localScale, right = new Vector3(1, 0, 0), up = new Vector3(0, 1, 0), forward = new Vector3(0, 0, 1);
        public void LookAt(Vector3 at) { forward = new Vector3(at.x - position.x, at.y - position.y, at.z - position.z); }
    }
    public enum PrimitiveType { Sphere, Cube }
    public class GameObject : Object
    {
        public static readonly List<GameObject> All = new List<GameObject>();
        public readonly List<Component> Components = new List<Component>();
        public readonly Transform transform = new Transform();
        public GameObject(string name) { transform.gameObject = this; All.Add(this); }
        public static GameObject CreatePrimitive(PrimitiveType type)
        {
            var made = new GameObject(type.ToString());
            made.AddComponent<Collider>();
            return made;
        }
        public T AddComponent<T>() where T : Component, new()
        {
            var made = new T { gameObject = this };
            Components.Add(made);
            Messages.Send(made, "Awake");
            Messages.Send(made, "OnEnable");
            return made;
        }
        public T GetComponent<T>() where T : Component { return Components.Find(component => component is T) as T; }
    }
    /// <summary>Unity's way to call a script: by name, where it has such a method.</summary>
    public static class Messages
    {
        public static void Send(Component to, string name, params object[] with)
        {
            var flags = System.Reflection.BindingFlags.Instance | System.Reflection.BindingFlags.Public | System.Reflection.BindingFlags.NonPublic;
            var method = to.GetType().GetMethod(name, flags);
            if (method != null) method.Invoke(to, with);
        }
        public static void SendAll(string name, params object[] with)
        {
            foreach (var thing in GameObject.All.ToArray())
                foreach (var component in thing.Components.ToArray()) Send(component, name, with);
        }
    }
    public struct Vector3
    {
        public float x, y, z;
        public Vector3(float x, float y, float z) { this.x = x; this.y = y; this.z = z; }
        public static Vector3 one { get { return new Vector3(1, 1, 1); } }
        public static Vector3 down { get { return new Vector3(0, -1, 0); } }
        public float magnitude { get { return (float)Math.Sqrt(Dot(this, this)); } }
        public static float Dot(Vector3 a, Vector3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
        public static Vector3 operator *(Vector3 a, float b) { return new Vector3(a.x * b, a.y * b, a.z * b); }
        public static Vector3 operator -(Vector3 a, Vector3 b) { return a + b * -1; }
        public static Vector3 operator +(Vector3 a, Vector3 b) { return new Vector3(a.x + b.x, a.y + b.y, a.z + b.z); }
    }
    public struct Vector2
    {
        public float x, y;
        public Vector2(float x, float y) { this.x = x; this.y = y; }
        public static Vector2 operator /(Vector2 a, float b) { return new Vector2(a.x / b, a.y / b); }
    }
    public struct Rect { public Rect(float x, float y, float width, float height) { } }
    public static class GUI { public static string Said = ""; public static void Label(Rect at, string text) { Said = text; } }
    public static class Mathf
    {
        public static float Abs(float x) { return Math.Abs(x); }
        public static float Max(float x, float y) { return Math.Max(x, y); }
        public static float Sin(float x) { return (float)Math.Sin(x); }
    }
    public static class Time
    {
        public static double fixedTimeAsDouble;
        public static float fixedDeltaTime { get { return 0.02f; } }
        public static float fixedTime { get { return (float)fixedTimeAsDouble; } }
    }
    public static class Debug { public static string Warned = ""; public static void LogWarning(object what) { Warned += what + "\n"; } }
    public static class AudioSettings { public static int outputSampleRate { get { return 48000; } } }
    public class AudioSource : Behaviour { }
    public class AudioListener : Behaviour { }
    /// <summary>A ball about Centre that moves and spins.</summary>
    public class Rigidbody : Component
    {
        public float mass;
        public Vector3 Centre, Velocity, Spin;
        public Vector3 worldCenterOfMass { get { return Centre; } }
        public Vector3 GetPointVelocity(Vector3 at)
        {
            var r = at - Centre;
            return Velocity + new Vector3(Spin.y * r.z - Spin.z * r.y, Spin.z * r.x - Spin.x * r.z, Spin.x * r.y - Spin.y * r.x);
        }
    }
    public class Collider : Component { }
    public class MeshCollider : Collider { }
    public struct RaycastHit
    {
        public Collider collider { get; set; }
        public Vector2 textureCoord { get { return new Vector2(); } }
        public Vector3 point { get; set; }
        public float distance { get; set; }
        public Vector3 normal { get { return new Vector3(0, 1, 0); } }
    }
    public static class Physics
    {
        /// <summary>The one thing that rays meet: a plane at height Top, which belongs to Ground.</summary>
        public static Collider Ground;
        public static float Top;
        public static Vector3 gravity { get { return new Vector3(0, -9.81f, 0); } }
        public static bool Raycast(Vector3 from, Vector3 along, out RaycastHit hit, float reach)
        {
            hit = new RaycastHit { collider = Ground, point = new Vector3(from.x, Top, from.z), distance = from.y - Top };
            return Ground != null && along.y < 0 && from.y > Top && hit.distance <= reach;
        }
    }
    public struct ContactPoint { public Vector3 point { get; set; } public Vector3 normal { get; set; } }
    public class Collision
    {
        public Vector3 impulse { get; set; }
        public Vector3 relativeVelocity { get; set; }
        public Collider collider { get; set; }
        public Rigidbody rigidbody { get { return null; } }
        public Vector3 Point, Normal = new Vector3(0, 1, 0);
        public ContactPoint GetContact(int index) { return new ContactPoint { point = Point, normal = Normal }; }
    }
    public class TextAsset : Object
    {
        readonly string held;
        public TextAsset(string text) { held = text; }
        public string text { get { return held; } }
    }
    [AttributeUsage(AttributeTargets.Field)] public class TooltipAttribute : Attribute { public TooltipAttribute(string words) { } }
    [AttributeUsage(AttributeTargets.Class)] public class RequireComponent : Attribute { public RequireComponent(Type type) { } }
    [AttributeUsage(AttributeTargets.Field)] public class TextAreaAttribute : Attribute { }
    [AttributeUsage(AttributeTargets.Field)] public class RangeAttribute : Attribute { public RangeAttribute(float least, float most) { } }
    [AttributeUsage(AttributeTargets.Class)] public class DefaultExecutionOrderAttribute : Attribute { public DefaultExecutionOrderAttribute(int order) { } }
}

namespace UnityEngine.Audio
{
    public class AudioMixer : UnityEngine.Object
    {
        public readonly System.Collections.Generic.Dictionary<string, float> Exposed = new System.Collections.Generic.Dictionary<string, float>();
        public bool SetFloat(string name, float value)
        {
            bool known = Exposed.ContainsKey(name);
            if (known) Exposed[name] = value;
            return known;
        }
    }
}

namespace AOT
{
    [AttributeUsage(AttributeTargets.Method)] public class MonoPInvokeCallbackAttribute : Attribute { public MonoPInvokeCallbackAttribute(Type type) { } }
}
namespace UnityEngine.Events
{
    public class UnityEvent<A, B>
    {
        event Action<A, B> called;
        public void AddListener(Action<A, B> to) { called += to; }
        public void Invoke(A a, B b) { if (called != null) called(a, b); }
    }
}
namespace UnityEngine.XR
{
    public enum XRNode { LeftHand = 4, RightHand = 5 }
    /// <summary>A controller that notes what it is told; Unity's own refuses an amplitude outside 0 to 1.</summary>
    public struct InputDevice
    {
        public static bool Connected = true;
        public static readonly List<float> Amplitudes = new List<float>();
        public static int Stops, Wrong;
        public XRNode Node;
        public bool isValid { get { return Connected && Node == XRNode.RightHand; } }
        public bool SendHapticImpulse(uint channel, float amplitude, float duration)
        {
            if (!isValid || channel != 0 || !(amplitude >= 0f && amplitude <= 1f) || !(duration > 0f)) Wrong++;
            Amplitudes.Add(amplitude);
            return true;
        }
        public void StopHaptics() { Stops++; }
    }
    public static class InputDevices
    {
        public static InputDevice GetDeviceAtXRNode(XRNode node) { return new InputDevice { Node = node }; }
    }
}
