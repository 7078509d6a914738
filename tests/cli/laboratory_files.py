"""Small files as a laboratory's programs write them."""

MOTION_COLUMNS = ("time", "knee_angle_r", "hip_flexion_r")
MOTION_ROWS = ((0.0, 1, 2), (0.1, 1, 2), (0.2, 1, 2), (0.3, 1, 2))


def mot(columns=MOTION_COLUMNS, rows=MOTION_ROWS, announced_rows=None, announced_columns=None, in_degrees="no"):
    """A motion file; its rows begin at line 8."""
    lines = ["walk", "version=1", f"nRows={announced_rows or len(rows)}",
             f"nColumns={announced_columns or len(columns)}", f"inDegrees={in_degrees}", "endheader",
             "\t".join(columns)]
    lines += ["\t".join(map(str, row)) for row in rows]
    return "\n".join(lines) + "\n"


def replaced(rows, index, row):
    return (*rows[:index], row, *rows[index + 1:])


def trc(markers=("RASI", "LASI"), frames=4, units="mm", announced_frames=None, announced_markers=None, changed=None):
    """A marker file at 60 Hz; its frames begin at line 7. changed: whole lines by frame."""
    axes = "\t".join(f"{axis}{i + 1}" for i in range(len(markers)) for axis in "XYZ")
    lines = ["PathFileType\t4\t(X/Y/Z)\twalk.trc",
             "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames",
             f"60\t60\t{announced_frames or frames}\t{announced_markers or len(markers)}\t{units}\t60\t1\t{frames}",
             "Frame#\tTime\t" + "\t\t\t".join(markers) + "\t\t", "\t\t" + axes, ""]
    for frame in range(frames):
        positions = [f"{frame + i:.1f}" for i in range(3 * len(markers))]
        lines.append("\t".join([str(frame + 1), f"{frame / 60:.5f}", *positions]))
    for frame, line in (changed or {}).items():
        lines[6 + frame] = line
    return "\n".join(lines) + "\n"


CEINMS_CURVES = "".join(
    f"<curve><name>{name}</name><xPoints>{x}</xPoints><yPoints>{y}</yPoints></curve>" for name, x, y in (
        ("activeForceLength", "0 0.5 1 1.5", "0 0.3 1 0"), ("passiveForceLength", "0 1 1.5", "0 0 1"),
        ("forceVelocity", "-1 0 1", "0 1 1.5"), ("tendonForceStrain", "-1 0 0.05", "0 0 1")))


def ceinms_project():
    """{file name: text} of a project of CEINMS with one muscle and one trial; its setup is setup.xml."""
    def table(column):
        return f"t\nnRows=3\nnColumns=2\nendheader\ntime\t{column}\n0\t0.1\n0.1\t0.2\n0.2\t0.1\n"

    numbers = {"c1": -0.4, "c2": -0.6, "shapeFactor": -0.5, "optimalFibreLength": 0.05, "pennationAngle": 0.4, "tendonSlackLength": 0.25,
               "maxIsometricForce": 3549, "strengthCoefficient": 1}
    muscle = "".join(f"<{name}>{value}</{name}>" for name, value in numbers.items())
    return {
        "setup.xml": "<ceinmsCalibration><subjectFile>subject.xml</subjectFile><excitationGeneratorFile>generator.xml</excitationGeneratorFile>"
                     "<calibrationFile>calibration.xml</calibrationFile><outputSubjectFile>o.xml</outputSubjectFile></ceinmsCalibration>",
        "subject.xml": "<subject><mtuDefault><emDelay>0.02</emDelay><percentageChange>0.1</percentageChange><damping>0.05</damping>"
                       f"{CEINMS_CURVES}</mtuDefault><mtuSet><mtu><name>sol</name>{muscle}</mtu></mtuSet>"
                       "<dofSet><dof><name>ankle</name><mtuNameSet>sol</mtuNameSet></dof></dofSet></subject>",
        "generator.xml": '<excitationGenerator><inputSignals type="EMG">sol_emg</inputSignals><mapping><excitation id="sol">'
                         '<input weight="1">sol_emg</input></excitation></mapping></excitationGenerator>',
        "calibration.xml": "<calibration><NMSmodel><type><openLoop/></type><tendon><stiff/></tendon><activation><exponential/></activation>"
                           "</NMSmodel><calibrationSteps><step><dofs>ankle</dofs><objectiveFunction><minimizeTorqueError/></objectiveFunction>"
                           "<parameterSet><parameter><name>shapeFactor</name><single/><absolute><range>-2.9 -0.1</range></absolute></parameter>"
                           "</parameterSet></step></calibrationSteps><trialSet>trial.xml</trialSet></calibration>",
        "trial.xml": "<inputData><muscleTendonLengthFile>lengths.sto</muscleTendonLengthFile><excitationsFile>emg.mot</excitationsFile>"
                     '<momentArmsFiles><momentArmsFile dofName="ankle">arms.sto</momentArmsFile></momentArmsFiles>'
                     "<externalTorquesFile>id.sto</externalTorquesFile></inputData>",
        "lengths.sto": table("sol"), "arms.sto": table("sol"), "emg.mot": table("sol_emg"), "id.sto": table("ankle_moment"),
    }
