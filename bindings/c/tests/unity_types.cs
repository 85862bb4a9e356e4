// The few types of Unity that the components use, so that they can be compiled without it. Nothing here does anything.
using System;

namespace UnityEngine
{
    public class Object { }
    public class Component : Object { public Transform transform; public T GetComponent<T>() { return default(T); } }
    public class MonoBehaviour : Component { }
    public class Transform : Component { public Vector3 position, forward; }
    public struct Vector3
    {
        public float x, y, z;
        public float magnitude { get { return 0f; } }
        public static float Dot(Vector3 a, Vector3 b) { return 0f; }
    }
    public struct Vector2
    {
        public float x, y;
        public Vector2(float x, float y) { this.x = x; this.y = y; }
        public static Vector2 operator /(Vector2 a, float b) { return a; }
    }
    public static class Mathf { public static float Abs(float x) { return x; } }
    public static class Time { public static double fixedTimeAsDouble { get { return 0; } } }
    public static class Debug { public static void LogWarning(object what) { } }
    public static class AudioSettings { public static int outputSampleRate { get { return 48000; } } }
    public class Collider : Component { }
    public class MeshCollider : Collider { }
    public struct RaycastHit
    {
        public Collider collider { get { return null; } }
        public Vector2 textureCoord { get { return new Vector2(); } }
        public Vector3 point { get { return new Vector3(); } }
        public float distance { get { return 0f; } }
    }
    public static class Physics
    {
        public static bool Raycast(Vector3 from, Vector3 along, out RaycastHit hit, float reach) { hit = new RaycastHit(); return false; }
    }
    public struct ContactPoint { public Vector3 normal { get { return new Vector3(); } } }
    public class Collision
    {
        public Vector3 impulse { get { return new Vector3(); } }
        public Vector3 relativeVelocity { get { return new Vector3(); } }
        public ContactPoint GetContact(int index) { return new ContactPoint(); }
    }
    public class TextAsset : Object { public string text { get { return ""; } } }
    [AttributeUsage(AttributeTargets.Field)] public class TooltipAttribute : Attribute { public TooltipAttribute(string words) { } }
    [AttributeUsage(AttributeTargets.Field)] public class TextAreaAttribute : Attribute { }
    [AttributeUsage(AttributeTargets.Class)] public class DefaultExecutionOrderAttribute : Attribute { public DefaultExecutionOrderAttribute(int order) { } }
}

namespace UnityEngine.Audio
{
    public class AudioMixer : UnityEngine.Object { public bool SetFloat(string name, float value) { return true; } }
}
