"""What kind of hysteresis do the data show, and which model can represent it?"""

import hysid


def report() -> str:
    joint, _ = hysid.specimen("reinforced-concrete-joint").data()
    diagnosis = hysid.diagnose(joint.x, joint.y, joint.time, records=joint.records)
    return "".join(f"{finding.name}: {finding.verdict}\n" for finding in diagnosis.properties)


if __name__ == "__main__":
    print(report(), end="")
