// A body that rings: what collisions with its collider sound like, and what a finger on it feels.
using UnityEngine;

namespace Asperity
{
    public sealed class AsperityBody : MonoBehaviour
    {
        [Tooltip("bar, tube, ring, plate, disc, bowl or block; empty where ModesJson is given")]
        public string Stock = "plate";
        [Tooltip("Longest side or diameter, m")]
        public float SizeM = 0.3f;
        public Material Made = Material.Wood;
        [Tooltip("A .modes.json of a recording or a mesh, as a text asset")]
        public TextAsset ModesJson;
        [Tooltip("Keys of a scene file's [[surface]], TOML, for what it feels like")]
        [TextArea] public string SurfaceTable = "";
        [Tooltip("What texture coordinates 0 to 1 span, m")]
        public float UvSizeM = 1f;
        [Tooltip("How loud blows are beside strokes; 1: as mechanics says; below 0: as the engine has it")]
        public float StrikeGain = -1f;
        [Tooltip("Weaker collisions are not reported, N s")]
        public float LeastImpulseNS = 1e-4f;

        public ulong Body { get; private set; }
        public ulong Surface { get; private set; }

        /// <summary>The engine that it is in: one that is disabled and enabled again is another one.</summary>
        Scene scene;

        void Start()
        {
            if (AsperityWorld.Current == null) Debug.LogWarning("Asperity: no AsperityWorld in this scene; add one");
            else Join();
        }

        /// <summary>Puts it into the engine that runs now; false: none does.</summary>
        public bool Join()
        {
            var world = AsperityWorld.Current;
            if (world == null || world.Scene == null) return false;
            if (world.Scene == scene) return Body != 0;
            scene = world.Scene;
            Body = Surface = 0;
            var body = new Body { SizeM = SizeM, Material = Made, StrikeGain = StrikeGain < 0f ? double.NaN : StrikeGain };
            if (ModesJson != null) body.ModesJson = ModesJson.text; else body.Stock = Stock;
            Body = scene.Add(body);
            Surface = scene.Add(new Surface { WidthM = UvSizeM, HeightM = UvSizeM, Body = Body, Table = SurfaceTable });
            return true;
        }

        /// <summary>Where a place lies on it that knows no texture coordinates: on a plane in the world, u along x and y, v along z.</summary>
        public Vector2 PlaneUv(Vector3 point) { return new Vector2(point.x + point.y, point.z) / UvSizeM; }

        void OnCollisionEnter(Collision collision)
        {
            float impulse = collision.impulse.magnitude;
            if (impulse < LeastImpulseNS || !Join()) return;
            // The approach along the normal; a resting contact has none.
            float speed = Mathf.Abs(Vector3.Dot(collision.relativeVelocity, collision.GetContact(0).normal));
            if (speed > 0f) AsperityWorld.Current.Report(Event.Collision(Body, impulse, speed, 0.5));
        }

        void OnDestroy()
        {
            var world = AsperityWorld.Current;
            if (world == null || scene == null || world.Scene != scene) return;
            if (Surface != 0) scene.RemoveSurface(Surface);
            if (Body != 0) scene.RemoveBody(Body);
            scene = null;
        }
    }
}
