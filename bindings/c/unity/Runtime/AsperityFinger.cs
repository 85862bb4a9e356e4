// A finger: casts along its forward axis, and touches the AsperityBody it meets. Put it on a fingertip; its channel is felt.
using UnityEngine;

namespace Asperity
{
    public sealed class AsperityFinger : MonoBehaviour
    {
        [Tooltip("How far in front of the transform it touches, m")]
        public float ReachM = 0.02f;
        [Tooltip("Force for each metre that it is pushed in, N/m")]
        public float StiffnessNM = 100f;
        public int HapticChannel;

        static ulong names;
        ulong contact;
        AsperityBody touched;
        Scene scene;
        Vector2 uv;
        Vector3 last;
        int side;

        void FixedUpdate()
        {
            var world = AsperityWorld.Current;
            if (world == null || world.Scene == null) return;
            RaycastHit hit;
            var found = Physics.Raycast(transform.position, transform.forward, out hit, ReachM) ? hit.collider.GetComponent<AsperityBody>() : null;
            if (found != touched || world.Scene != scene) Lift(world);
            if (found == null || !found.Join() || found.Surface == 0) return;
            // Mesh colliders know texture coordinates; of any other the side counts that the finger is on.
            bool drawn = hit.collider is MeshCollider;
            var own = found.OwnPlace(hit.point);
            side = found.Side(hit.normal, touched == null ? -1 : side);
            uv = drawn ? hit.textureCoord : AsperityBody.OnSide(own, side) / found.UvSizeM;
            var along = AsperityBody.OnSide((own - last) * (1f / Time.fixedDeltaTime), side);
            last = own;
            double force = StiffnessNM * (ReachM - hit.distance);
            if (touched == null)
            {
                contact = ++names;
                touched = found;
                scene = world.Scene;
                world.Report(Event.Begin(contact, found.Surface, HapticChannel, uv.x, uv.y, force));
            }
            else
            {
                var told = Event.Move(contact, uv.x, uv.y, force);
                // Along u and v of a mesh nobody but the mesh knows it: there the engine finds it out.
                if (!drawn) { told.VelocityU = along.x; told.VelocityV = along.y; }
                world.Report(told);
            }
        }

        void Lift(AsperityWorld world)
        {
            // A contact of an engine that is gone has ended with it.
            if (touched != null && world.Scene == scene) world.Report(Event.End(contact));
            touched = null;
        }

        void OnDisable()
        {
            if (AsperityWorld.Current != null) Lift(AsperityWorld.Current);
        }
    }
}
