"""Two industrial arms as their makers' descriptions have them: frames, masses and inertias of the links that move.

UR10e: Universal Robots' ROS description (ur_e_description, ur10e.urdf). Panda: franka_description (panda.urdf),
without a hand. A row is a joint's origin (xyz, rpy) and axis, and its link's mass, centre (xyz), axes (rpy) and inertia
(xx, xy, xz, yy, yz, zz).
"""

UR10E = (
    ("0 0 0.181", "0 0 0", "0 0 1", 7.778, "0 0 0", "0 0 0", "0.0314743125769 0.0 0.0 0.0314743125769 0.0 0.021875625"),
    (
        "0 0.176 0",
        "0 1.57079632679 0",
        "0 1 0",
        12.93,
        "0 0 0.3065",
        "0 0 0",
        "0.42307374077 0.0 0.0 0.42307374077 0.0 0.036365625",
    ),
    (
        "0 -0.137 0.613",
        "0 0 0",
        "0 1 0",
        3.87,
        "0 0 0.2855",
        "0 0 0",
        "0.110590365764 0.0 0.0 0.110590365764 0.0 0.010884375",
    ),
    (
        "0 0 0.571",
        "0 1.57079632679 0",
        "0 1 0",
        1.96,
        "0 0.135 0",
        "0 0 0",
        "0.0051082479567 0.0 0.0 0.0051082479567 0.0 0.0055125",
    ),
    ("0 0.135 0", "0 0 0", "0 0 1", 1.96, "0 0 0.12", "0 0 0", "0.0051082479567 0.0 0.0 0.0051082479567 0.0 0.0055125"),
    (
        "0 0 0.12",
        "0 0 0",
        "0 1 0",
        0.202,
        "0 0.092 0",
        "1.57079632679 0 0",
        "0.000144345775595 0.0 0.0 0.000144345775595 0.0 0.000204525",
    ),
)

PANDA = (
    (
        "0 0 0.333",
        "0 0 0",
        "0 0 1",
        4.970684,
        "0.003875 0.002081 -0.04762",
        "0 0 0",
        "0.70337 -0.000139 0.006772 0.70661 0.019169 0.009117",
    ),
    (
        "0 0 0",
        "-1.5707963267948966 0 0",
        "0 0 1",
        0.646926,
        "-0.003141 -0.02872 0.003495",
        "0 0 0",
        "0.007962 -0.003925 0.010254 0.02811 0.000704 0.025995",
    ),
    (
        "0 -0.316 0",
        "1.5707963267948966 0 0",
        "0 0 1",
        3.228604,
        "0.027518 0.039252 -0.066502",
        "0 0 0",
        "0.037242 -0.004761 -0.011396 0.036155 -0.012805 0.01083",
    ),
    (
        "0.0825 0 0",
        "1.5707963267948966 0 0",
        "0 0 1",
        3.587895,
        "-0.05317 0.104419 0.027454",
        "0 0 0",
        "0.025853 0.007796 -0.001332 0.019552 0.008641 0.028323",
    ),
    (
        "-0.0825 0.384 0",
        "-1.5707963267948966 0 0",
        "0 0 1",
        1.225946,
        "-0.011953 0.041065 -0.038437",
        "0 0 0",
        "0.035549 -0.002117 -0.004037 0.029474 0.000229 0.008627",
    ),
    (
        "0 0 0",
        "1.5707963267948966 0 0",
        "0 0 1",
        1.666555,
        "0.060149 -0.014117 -0.010517",
        "0 0 0",
        "0.001964 0.000109 -0.001158 0.004354 0.000341 0.005433",
    ),
    (
        "0.088 0 0",
        "1.5707963267948966 0 0",
        "0 0 1",
        0.735522,
        "0.010517 -0.004252 0.061597",
        "0 0 0",
        "0.012516 -0.000428 -0.001196 0.010027 -0.000741 0.004815",
    ),
)


def urdf_of(rows):
    """A URDF of these links, one after the other."""
    text = '<robot name="arm"><link name="link0"/>'
    for number, (xyz, rpy, axis, mass, center, turned, inertia) in enumerate(rows, 1):
        names = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
        moments = " ".join(f'{name}="{value}"' for name, value in zip(names, inertia.split(), strict=True))
        text += (
            f'<link name="link{number}"><inertial><origin xyz="{center}" rpy="{turned}"/><mass value="{mass}"/>'
            f"<inertia {moments}/></inertial></link>"
            f'<joint name="joint{number}" type="revolute"><origin xyz="{xyz}" rpy="{rpy}"/>'
            f'<parent link="link{number - 1}"/><child link="link{number}"/><axis xyz="{axis}"/>'
            f'<limit lower="-3" upper="3" effort="100" velocity="3"/></joint>'
        )
    return (
        text
        + '<link name="flange"/><joint name="fixed" type="fixed"><origin xyz="0 0 0.1"/>'
        + (f'<parent link="link{len(rows)}"/><child link="flange"/></joint></robot>')
    )
