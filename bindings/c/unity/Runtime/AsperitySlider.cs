// What slides or rolls over an AsperityBody: put it on things with a Rigidbody that shall scrape and roll there, not only knock.
using UnityEngine;

namespace Asperity
{
    [RequireComponent(typeof(Rigidbody))]
    public sealed class AsperitySlider : MonoBehaviour
    {
        [Tooltip("Radius of what can roll, a ball's or a wheel's, m; 0: it slides as fast as it moves")]
        public float RollRadiusM;
        [Tooltip("The haptic channel that feels it; -1: nobody")]
        public int HapticChannel = -1;

        /// <summary>Slower than this it rests, m/s; after so many steps of rest its contact ends.</summary>
        const float RestMS = 0.002f;
        const int RestSteps = 6;

        static ulong names = 1UL << 32;   // a game's own contacts stay free below
        ulong contact;
        int rested, side;
        Vector3 run;
        AsperityBody ground;
        Scene scene;
        Rigidbody body;

        void Awake() { body = GetComponent<Rigidbody>(); }

        void OnCollisionStay(Collision collision)
        {
            var world = AsperityWorld.Current;
            if (world == null || world.Scene == null) return;
            if (world.Scene != scene) { ground = null; scene = world.Scene; }
            var found = collision.collider.GetComponent<AsperityBody>();
            // One ground at a time: the one that it is on.
            if (found == null || ground != null && found != ground || !found.Join() || found.Surface == 0) return;
            var at = collision.GetContact(0);
            var beneath = collision.rigidbody == null ? new Vector3() : collision.rigidbody.GetPointVelocity(at.point);
            beneath = beneath + found.transform.right * found.BeltMS.x + found.transform.up * found.BeltMS.y + found.transform.forward * found.BeltMS.z;
            var slip = Along(body.GetPointVelocity(at.point) - beneath, at.normal);
            var path = RollRadiusM > 0f ? Along(body.GetPointVelocity(body.worldCenterOfMass) - beneath, at.normal) : slip;
            rested = Mathf.Max(path.magnitude, slip.magnitude) < RestMS ? rested + 1 : 0;
            if (rested > (ground == null ? 0 : RestSteps)) { Leave(world); return; }
            // What lies on a belt stands still on its surface.
            side = found.Side(at.normal, ground == null ? -1 : side);
            run = ground == null ? new Vector3() : run + found.BeltMS * Time.fixedDeltaTime;
            var uv = AsperityBody.OnSide(found.OwnPlace(at.point) - run, side) / found.UvSizeM;
            var along = AsperityBody.OnSide(found.Own(path), side);
            double force = collision.impulse.magnitude / Time.fixedDeltaTime;
            var told = ground == null
                ? Event.Begin(contact = ++names, found.Surface, HapticChannel, uv.x, uv.y, force)
                : Event.Move(contact, uv.x, uv.y, force);
            told.VelocityU = along.x;
            told.VelocityV = along.y;
            world.Report(RollRadiusM > 0f ? told.Rolling(RollRadiusM, slip.magnitude) : told);
            ground = found;
        }

        void OnCollisionExit(Collision collision)
        {
            var world = AsperityWorld.Current;
            if (world != null && ground != null && collision.collider.GetComponent<AsperityBody>() == ground) Leave(world);
        }

        void OnDisable()
        {
            if (AsperityWorld.Current != null) Leave(AsperityWorld.Current);
        }

        void Leave(AsperityWorld world)
        {
            // A contact of an engine that is gone has ended with it.
            if (ground != null && world.Scene == scene) world.Report(Event.End(contact));
            ground = null;
            rested = 0;
        }

        static Vector3 Along(Vector3 v, Vector3 normal) { return v - normal * Vector3.Dot(v, normal); }
    }
}
