//! The C++ class.

use crate::description::Argument;
use crate::subject::Subject;

/// The header file.
pub(super) fn header(subject: &Subject<'_>) -> String {
    let name = subject.name();
    let upper = name.to_uppercase();
    format!(
        "// {name}Material.h: a uniaxialMaterial of OpenSees around {name}.c. Facts about the model: see {name}.h.
#ifndef {upper}_MATERIAL_H
#define {upper}_MATERIAL_H

#include <UniaxialMaterial.h>

#include \"{name}.h\"

class {name}Material : public UniaxialMaterial
{{
  public:
    explicit {name}Material(int tag);
    {name}Material();

    const char *getClassType(void) const {{ return \"{name}Material\"; }}

    int setTrialStrain(double strain, double strainRate = 0.0);
    double getStrain(void);
    double getStrainRate(void);
    double getStress(void);
    double getTangent(void);
    double getInitialTangent(void);

    int commitState(void);
    int revertToLastCommit(void);
    int revertToStart(void);

    UniaxialMaterial *getCopy(void);

    int sendSelf(int commitTag, Channel &channel);
    int recvSelf(int commitTag, Channel &channel, FEM_ObjectBroker &broker);
    void Print(OPS_Stream &stream, int flag = 0);

  private:
    struct Point {{
        double strain;
        double rate;
        double stress;
        double tangent;
    }};

    {name}_model model;
    Point trial;
    Point committed;
    double initialTangent;
}};

#endif
"
    )
}

/// The source file.
pub(super) fn source(subject: &Subject<'_>) -> String {
    let name = subject.name();
    let upper = name.to_uppercase();
    let given = |zero: bool| -> String {
        let one = |argument: &Argument| match (argument, zero) {
            (Argument::TimeStep, true) | (Argument::Rate, true) | (Argument::Input(_), true) => ", 0.0",
            (Argument::TimeStep, false) => ", ops_Dt",
            (Argument::Rate, false) => ", strainRate",
            (Argument::Input(_), false) => ", strain",
        };
        subject.description().arguments.iter().map(one).collect()
    };
    format!(
        "// {name}Material.cpp: see {name}Material.h.

#include \"{name}Material.h\"

#include <Channel.h>
#include <FEM_ObjectBroker.h>
#include <OPS_Globals.h>
#include <OPS_Stream.h>
#include <Vector.h>
#include <elementAPI.h>

#include <string.h>

// A number that no material of OpenSees has.
static const int CLASS_TAG = {class_tag};

static const int STATE_NUMBERS = {upper}_STATE_BYTES / sizeof(double);
static const int NUMBERS = STATE_NUMBERS + 7;

// A checksum of all numbers but the last one (FNV-1a).
static double sumOf(Vector &data)
{{
    unsigned long sum = 2166136261UL;
    for (int i = 0; i < NUMBERS - 1; i++) {{
        unsigned char bytes[sizeof(double)];
        const double number = data(i);
        memcpy(bytes, &number, sizeof bytes);
        for (size_t k = 0; k < sizeof bytes; k++)
            sum = ((sum ^ bytes[k]) * 16777619UL) & 0xffffffffUL;
    }}
    return (double)sum;
}}

// True for a tag and a point that a material can have.
static bool isSound(Vector &data)
{{
    for (int i = 1; i < 6; i++)
        if (!(data(i) - data(i) == 0.0))
            return false;
    return data(0) >= -2147483647.0 && data(0) <= 2147483647.0 && data(0) == (double)(int)data(0);
}}

OPS_Export void *OPS_{name}(void)
{{
    int tag;
    int count = 1;
    if (OPS_GetIntInput(&count, &tag) != 0) {{
        opserr << \"WARNING: the command is uniaxialMaterial {name} tag\" << endln;
        return 0;
    }}
    return new {name}Material(tag);
}}

{name}Material::{name}Material(int tag) : UniaxialMaterial(tag, CLASS_TAG)
{{
    this->revertToStart();
}}

{name}Material::{name}Material() : UniaxialMaterial(0, CLASS_TAG)
{{
    this->revertToStart();
}}

int {name}Material::setTrialStrain(double strain, double strainRate)
{{
    trial.strain = strain;
    trial.rate = strainRate;
    trial.stress = {name}_trial_tangent(&model{given}, &trial.tangent);
    return 0;
}}

double {name}Material::getStrain(void)
{{
    return trial.strain;
}}

double {name}Material::getStrainRate(void)
{{
    return trial.rate;
}}

double {name}Material::getStress(void)
{{
    return trial.stress;
}}

double {name}Material::getTangent(void)
{{
    return trial.tangent;
}}

double {name}Material::getInitialTangent(void)
{{
    return initialTangent;
}}

int {name}Material::commitState(void)
{{
    {name}_commit(&model);
    committed = trial;
    return 0;
}}

int {name}Material::revertToLastCommit(void)
{{
    {name}_revert(&model);
    trial = committed;
    return 0;
}}

int {name}Material::revertToStart(void)
{{
    {name}_reset(&model);
    trial.strain = 0.0;
    trial.rate = 0.0;
    trial.stress = {name}_trial_tangent(&model{at_zero}, &trial.tangent);
    {name}_revert(&model);
    initialTangent = trial.tangent;
    committed = trial;
    return 0;
}}

UniaxialMaterial *{name}Material::getCopy(void)
{{
    {name}Material *copy = new {name}Material(this->getTag());
    copy->model = model;
    copy->trial = trial;
    copy->committed = committed;
    return copy;
}}

int {name}Material::sendSelf(int commitTag, Channel &channel)
{{
    double state[STATE_NUMBERS];
    Vector data(NUMBERS);
    unsigned char bytes[{upper}_STATE_BYTES];
    {name}_save(&model, bytes);
    memcpy(state, bytes, sizeof bytes);
    data(0) = this->getTag();
    data(1) = committed.strain;
    data(2) = committed.rate;
    data(3) = committed.stress;
    data(4) = committed.tangent;
    data(5) = initialTangent;
    for (int i = 0; i < STATE_NUMBERS; i++)
        data(6 + i) = state[i];
    data(NUMBERS - 1) = sumOf(data);
    if (channel.sendVector(this->getDbTag(), commitTag, data) < 0) {{
        opserr << \"{name}Material::sendSelf failed to send its data\" << endln;
        return -1;
    }}
    return 0;
}}

int {name}Material::recvSelf(int commitTag, Channel &channel, FEM_ObjectBroker &)
{{
    double state[STATE_NUMBERS];
    Vector data(NUMBERS);
    unsigned char bytes[{upper}_STATE_BYTES];
    if (channel.recvVector(this->getDbTag(), commitTag, data) < 0) {{
        opserr << \"{name}Material::recvSelf failed to receive its data\" << endln;
        return -1;
    }}
    for (int i = 0; i < STATE_NUMBERS; i++)
        state[i] = data(6 + i);
    memcpy(bytes, state, sizeof bytes);
    if (data(NUMBERS - 1) != sumOf(data) || !isSound(data) || !{name}_restore(&model, bytes)) {{
        opserr << \"{name}Material::recvSelf received a state that is damaged or of another material\" << endln;
        return -1;
    }}
    this->setTag((int)data(0));
    committed.strain = data(1);
    committed.rate = data(2);
    committed.stress = data(3);
    committed.tangent = data(4);
    initialTangent = data(5);
    trial = committed;
    return 0;
}}

void {name}Material::Print(OPS_Stream &stream, int)
{{
    stream << \"{name}Material, tag: \" << this->getTag() << endln;
}}
",
        given = given(false),
        at_zero = given(true),
        class_tag = class_tag(name),
    )
}

/// A class tag from the name, between those of OpenSees and the largest number.
fn class_tag(name: &str) -> u32 {
    let hash = name.bytes().fold(5381_u32, |hash, byte| hash.wrapping_mul(33) ^ u32::from(byte));
    1_000_000 + hash % 1_000_000_000
}
