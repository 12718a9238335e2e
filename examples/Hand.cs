// The hand of hand.c in C#: loads a mesh, presses a point into it from above, and prints position and force.
//
//   mcs Hand.cs && LD_LIBRARY_PATH=PREFIX/lib mono Hand.exe mesh.obj 0.001      (or as a part of a .NET project)
using System;
using System.Globalization;
using System.Runtime.InteropServices;

static class Gliss
{
    const string Library = "libgliss.so.0";

    [StructLayout(LayoutKind.Sequential)]
    public struct Options  // gliss_options
    {
        public uint Size, Precision;
        public double Unit;
        [MarshalAs(UnmanagedType.LPStr)] public string Level;  // UTF-8 on Linux
        public uint Construction, Threads;
        [MarshalAs(UnmanagedType.LPStr)] public string Crease;
        public uint Orient, Flip;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct Vector
    {
        public double X, Y, Z;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct Object  // gliss_object
    {
        public uint Size, Method;
        public IntPtr Surface;
        public double Stiffness;
        public double RotationW, RotationX, RotationY, RotationZ;
        public Vector Position;
        public double Settle, FrictionStatic, FrictionDynamic, FrictionSettle, Damping, Viscosity;
        public double MagnetForce, MagnetRange;
        public uint Texture, Reserved;
        public double TextureHeight, TexturePeriod;
        public Vector TextureAlong;
        public double Tick;
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct Contact  // gliss_contact
    {
        public uint Touching, Face;
        public double Xi, Eta;
        public Vector Scp, Normal, Push;
        public double Distance;
        public uint Flags, Iterations;
        public ulong Reserved0, Reserved1;
    }

    [DllImport(Library)] static extern IntPtr gliss_last_error();
    [DllImport(Library)] public static extern uint gliss_abi_version();
    [DllImport(Library)] public static extern int gliss_surface_load(
        [MarshalAs(UnmanagedType.LPStr)] string path, ref Options options, out IntPtr surface);
    [DllImport(Library)] public static extern void gliss_surface_release(IntPtr surface);
    [DllImport(Library)] public static extern double gliss_surface_unit(IntPtr surface);
    [DllImport(Library)] public static extern int gliss_surface_bounds(IntPtr surface, out Vector low, out Vector high);
    [DllImport(Library)] public static extern int gliss_object_set_defaults(ref Object obj, UIntPtr size);
    [DllImport(Library)] public static extern int gliss_hand_create(
        ref Object objects, UIntPtr count, IntPtr points, UIntPtr hips, out IntPtr hand);
    [DllImport(Library)] public static extern void gliss_hand_release(IntPtr hand);
    [DllImport(Library)] public static extern int gliss_hand_tick(IntPtr hand, ref Vector position, out Vector force);
    [DllImport(Library)] public static extern int gliss_hand_contact(
        IntPtr hand, UIntPtr hip, UIntPtr obj, out Contact contact);
    [DllImport(Library)] public static extern int gliss_guard_create(double maxForce, double maxRate, out IntPtr guard);
    [DllImport(Library)] public static extern void gliss_guard_release(IntPtr guard);
    [DllImport(Library)] public static extern int gliss_guard_step(
        IntPtr guard, long now, long measured, ref Vector wanted, out Vector force, out uint state);

    // Throws what the library says of a call that has failed.
    public static void Check(int code, string doing)
    {
        if (code != 0) throw new InvalidOperationException(doing + ": " + Marshal.PtrToStringAnsi(gliss_last_error()));
    }
}

static class Hand
{
    static string Text(double x)  // as %.9g
    {
        return x.ToString("G9", CultureInfo.InvariantCulture).Replace("E", "e");
    }

    static void Run(string mesh, double metres)
    {
        if (Gliss.gliss_abi_version() >> 16 != 0)  // structs and functions may be other than above
            throw new InvalidOperationException("libgliss.so.0 is of another ABI than this program");
        var options = new Gliss.Options { Size = (uint)Marshal.SizeOf(typeof(Gliss.Options)), Unit = metres };
        IntPtr surface, hand, guard;
        Gliss.Check(Gliss.gliss_surface_load(mesh, ref options, out surface), mesh);
        var obj = new Gliss.Object();
        Gliss.Check(Gliss.gliss_object_set_defaults(ref obj, (UIntPtr)(ulong)Marshal.SizeOf(typeof(Gliss.Object))), "the object");
        obj.Surface = surface;
        obj.FrictionStatic = 0.5;
        obj.FrictionDynamic = 0.3;
        Gliss.Check(Gliss.gliss_hand_create(ref obj, (UIntPtr)1, IntPtr.Zero, UIntPtr.Zero, out hand), "the hand");
        Gliss.Check(Gliss.gliss_guard_create(3.3, 1000, out guard), "the guard");

        Gliss.Vector low, high, wanted, force;
        Gliss.Check(Gliss.gliss_surface_bounds(surface, out low, out high), "the bounds");
        double unit = Gliss.gliss_surface_unit(surface);
        var at = new Gliss.Vector {
            X = unit * (low.X + high.X) / 2, Y = unit * (low.Y + high.Y) / 2, Z = unit * high.Z + 1e-3 };
        Console.WriteLine("z_m,wanted_N,sent_N,distance_m");
        for (int tick = 0; tick < 600; ++tick, at.Z -= 5e-6)
        {
            Gliss.Contact contact;
            uint state;
            Gliss.Check(Gliss.gliss_hand_tick(hand, ref at, out wanted), "a tick");
            long now = 1000000L * tick;  // ns
            Gliss.Check(Gliss.gliss_guard_step(guard, now, now, ref wanted, out force, out state), "the guard");
            Gliss.Check(Gliss.gliss_hand_contact(hand, UIntPtr.Zero, UIntPtr.Zero, out contact), "the contact");
            if (tick % 50 == 0)
                Console.WriteLine(Text(at.Z) + "," + Text(wanted.Z) + "," + Text(force.Z) + "," + Text(unit * contact.Distance));
        }
        Gliss.gliss_guard_release(guard);
        Gliss.gliss_hand_release(hand);
        Gliss.gliss_surface_release(surface);
    }

    static int Main(string[] words)
    {
        if (words.Length != 2)
        {
            Console.Error.WriteLine("usage: Hand.exe MESH UNIT, the metres in one unit of the mesh");
            return 2;
        }
        try
        {
            Run(words[0], double.Parse(words[1], CultureInfo.InvariantCulture));
            return 0;
        }
        catch (InvalidOperationException error)
        {
            Console.Error.WriteLine("Hand: " + error.Message);
            return 1;
        }
    }
}
