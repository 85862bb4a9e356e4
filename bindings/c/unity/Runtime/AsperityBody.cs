// A body that rings: what collisions with its collider sound like, and what a finger on it feels.
using System;
using UnityEngine;

namespace Asperity
{
    public sealed class AsperityBody : MonoBehaviour
    {
        [Tooltip("bar, tube, ring, plate, disc, bowl, block, box, can, bottle, pan, barrel, door, sheet or cushion; empty where ModesJson is given")]
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
        [Tooltip("An impact that comes sooner after one that was as strong is dropped, s; 0 drops none")]
        public float LeastTimeS = 0f;
        [Tooltip("Spread of equal blows; 0: each sounds like the last, 1: they differ as real ones do")]
        [Range(0f, 1f)] public float Variation = 0f;
        [Tooltip("Weaker collisions are not reported, N s")]
        public float LeastImpulseNS = 1e-4f;

        [Tooltip("Velocity of its surface in its own space, m/s: a conveyor belt")]
        public Vector3 BeltMS;

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
            if (LeastTimeS > 0f) body.Table = FormattableString.Invariant($"least_time_s = {(double)LeastTimeS:0.0#####}\n");
            if (Variation > 0f) body.Table += FormattableString.Invariant($"variation = {(double)Variation:0.0#####}\n");
            if (ModesJson != null) body.ModesJson = ModesJson.text; else body.Stock = Stock;
            Body = scene.Add(body);
            Surface = scene.Add(new Surface { WidthM = UvSizeM, HeightM = UvSizeM, Body = Body, Table = SurfaceTable });
            return true;
        }

        /// <summary>A direction in its own space, m: its scale does not count.</summary>
        public Vector3 Own(Vector3 along)
        {
            return new Vector3(Vector3.Dot(along, transform.right), Vector3.Dot(along, transform.up), Vector3.Dot(along, transform.forward));
        }

        /// <summary>A place in its own space, m.</summary>
        public Vector3 OwnPlace(Vector3 point) { return Own(point - transform.position); }

        /// <summary>The axis of its own that a normal is nearest to; the one before (-1: none), until another is clearly nearer.</summary>
        public int Side(Vector3 normal, int before)
        {
            var own = Own(normal);
            float[] along = { Mathf.Abs(own.x), Mathf.Abs(own.y), Mathf.Abs(own.z) };
            if (before >= 0) along[before] *= 1.2f;
            return along[1] >= along[0] && along[1] >= along[2] ? 1 : along[0] >= along[2] ? 0 : 2;
        }

        /// <summary>A vector of its own space along u and v of one of its sides.</summary>
        public static Vector2 OnSide(Vector3 own, int side)
        {
            return side == 1 ? new Vector2(own.x, own.z) : side == 0 ? new Vector2(own.z, own.y) : new Vector2(own.x, own.y);
        }

        void OnCollisionEnter(Collision collision)
        {
            float impulse = collision.impulse.magnitude;
            if (impulse < LeastImpulseNS || !Join()) return;
            // The approach along the normal; a resting contact has none.
            var contact = collision.GetContact(0);
            float speed = Mathf.Abs(Vector3.Dot(collision.relativeVelocity, contact.normal));
            if (speed <= 0f) return;
            var blow = Event.Collision(Body, impulse, speed, 0.5);
            var at = OwnPlace(contact.point);
            blow.AtX = at.x; blow.AtY = at.y; blow.AtZ = at.z;
            AsperityWorld.Current.Report(blow);
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
