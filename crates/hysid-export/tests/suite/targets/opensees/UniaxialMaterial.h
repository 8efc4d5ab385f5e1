// Declarations of those parts of OpenSees' interface that a uniaxialMaterial uses, for tests without OpenSees.
#pragma once

class Channel;
class FEM_ObjectBroker;
class OPS_Stream;

class Material
{
  public:
    Material(int tag, int classTag) : tag(tag), classTag(classTag) {}
    virtual ~Material() {}
    int getTag(void) const { return tag; }
    void setTag(int newTag) { tag = newTag; }
    int getClassTag(void) const { return classTag; }
    int getDbTag(void) const { return 0; }
    virtual const char *getClassType(void) const = 0;
    virtual int sendSelf(int commitTag, Channel &channel) = 0;
    virtual int recvSelf(int commitTag, Channel &channel, FEM_ObjectBroker &broker) = 0;
    virtual void Print(OPS_Stream &stream, int flag = 0) = 0;

  private:
    int tag;
    int classTag;
};

class UniaxialMaterial : public Material
{
  public:
    UniaxialMaterial(int tag, int classTag) : Material(tag, classTag) {}
    virtual int setTrialStrain(double strain, double strainRate = 0.0) = 0;
    virtual double getStrain(void) = 0;
    virtual double getStrainRate(void) = 0;
    virtual double getStress(void) = 0;
    virtual double getTangent(void) = 0;
    virtual double getInitialTangent(void) = 0;
    virtual int commitState(void) = 0;
    virtual int revertToLastCommit(void) = 0;
    virtual int revertToStart(void) = 0;
    virtual UniaxialMaterial *getCopy(void) = 0;
};

bool OPS_addUniaxialMaterial(UniaxialMaterial *material);
