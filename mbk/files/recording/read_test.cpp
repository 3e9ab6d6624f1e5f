#include "mbk/files/recording/read.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>

#include "mbk/files/c3d/test_c3d.h"
#include "mbk/files/contents/test_files.h"
#include "mbk/files/recording/channel_table.h"
#include "mbk/files/recording/inspect.h"

namespace mbk::recording {
namespace {

using test::double5;
using test::header5;
using test::logs;
using test::struct5;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

ReadOptions with_channels(std::string_view map) {
  ReadOptions options;
  options.channels = parse_channel_map(map).value();
  return options;
}

std::vector<std::string> names_of(const Recording& recording) {
  std::vector<std::string> names;
  for (const Channel& channel : recording.channels) names.push_back(channel.name);
  return names;
}

/// Files of one test and what reading them gives.
class Read : public testing::Test {
 protected:
  Recording good(std::string_view bytes, const ReadOptions& options = {}) {
    auto recording = read(folder_.write("file", bytes), options);
    EXPECT_TRUE(recording) << recording.error().line();
    return recording ? *recording : Recording{};
  }
  Error bad(std::string_view bytes, const ReadOptions& options = {}) {
    const auto recording = read(folder_.write("file", bytes), options);
    EXPECT_FALSE(recording);
    if (recording) return {};
    EXPECT_THAT(recording.error().where, HasSubstr((folder_ / "file").string()));
    EXPECT_EQ(recording.error().line().find('\n'), std::string::npos);
    return recording.error();
  }
  test::Folder folder_;
};

// ---- arithmetic in the map ----

TEST_F(Read, ScalesAndShiftsASourceBeforeTheUnit) {
  const std::string csv = "time,Vx,clip\n0,1,10\n0.1,-2,20\n";
  const Recording recording = good(csv, with_channels("Fx=Vx*-8.56+0.54:N,Fy=-Vx*2:mN,x=clip-5:mm"));
  EXPECT_EQ(recording.find("force_x")->values, Vector(Eigen::Vector2d(-8.56 + 0.54, -8.56 * -2 + 0.54)));
  EXPECT_EQ(recording.find("force_x")->unit, "N");
  EXPECT_EQ(recording.find("force_y")->values, Vector(Eigen::Vector2d(-2.0 / 1e3, 4.0 / 1e3)));
  EXPECT_EQ(recording.find("hand_x")->values, Vector(Eigen::Vector2d(5.0 / 1e3, 15.0 / 1e3)));
  EXPECT_THAT(recording.notes, Contains(AllOf(HasSubstr("force_x"), HasSubstr("Vx*-8.56+0.54"))));
}

TEST_F(Read, TakesANameBeforeArithmetic) {
  const std::string csv = "time,a,a*2,a*2+1,hand-1\n0,1,5,7,9\n0.1,1,5,7,9\n";
  for (const auto& [map, value] : {std::pair{"x=a*2+1", 7.0},
                                   {"x=a*2+2", 7.0},
                                   {"x=a*2", 5.0},
                                   {"x=a*3", 3.0},
                                   {"x=hand-1", 9.0},
                                   {"x=hand-1*2-3", 15.0},
                                   {"x=2*4", 4.0}}) {
    EXPECT_EQ(good(csv, with_channels(map)).channels.front().values[1], value) << map;
  }
}

TEST_F(Read, NamesWhatArithmeticDoesNotFind) {
  const std::string csv = "time,a\n0,1\n0.1,1\n";
  EXPECT_THAT(bad(csv, with_channels("x=b*2+1")).message,
              AllOf(HasSubstr("'b*2+1'"), HasSubstr("'b'"), HasSubstr("2 columns")));
  EXPECT_THAT(bad(csv, with_channels("x=a*2:furlong")).message, HasSubstr("'furlong'"));
  const Error none = bad(csv, with_channels("x=a*0"));
  EXPECT_EQ(none.kind, ErrorKind::usage);
  EXPECT_THAT(none.message, AllOf(HasSubstr("channel x"), HasSubstr("gain"), HasSubstr("'a'")));
}

// ---- columns of several matrices ----

TEST_F(Read, CombinesColumnsOfSeveralMatrices) {
  const Matrix pos = Matrix::Random(30, 3), force = Matrix::Random(3, 30);
  const Vector t = Vector::LinSpaced(30, 0.0, 0.29);
  const std::string bytes = header5() + double5("pos", pos) + double5("force", force) + double5("t", t);
  const Recording recording = good(bytes, with_channels("time=t,x=pos[1],y=pos[ 3 ],Fx=-force[2]*2+1:mN"));
  EXPECT_EQ(recording.time, t);
  EXPECT_EQ(recording.find("hand_x")->values, pos.col(0));
  EXPECT_EQ(recording.find("hand_y")->values, pos.col(2));  // the longer side of `pos` runs down, of `force` across
  const Vector expected = ((1.0 - 2.0 * force.row(1).array()) / 1e3).matrix().transpose();
  EXPECT_LT((recording.find("force_x")->values - expected).cwiseAbs().maxCoeff(), 1e-18);
  EXPECT_EQ(recording.find("force_x")->origin.source, "-force[2]*2+1");
}

TEST_F(Read, TakesTheUnitOfAMatrixFromItsNameAndTheOnlyColumnOfAVector) {
  const std::string bytes = header5() + double5("pos_mm", Matrix::Constant(5, 2, 250.0)) +
                            double5("load", Matrix::Constant(5, 1, 3.0)) + double5("time", Vector::LinSpaced(5, 0, 1));
  const Recording recording = good(bytes, with_channels("x=pos_mm[2],Fx=load[1]"));
  EXPECT_EQ(recording.find("hand_x")->values, Vector::Constant(5, 0.25));
  EXPECT_EQ(recording.find("force_x")->values, Vector::Constant(5, 3.0));
  EXPECT_THAT(recording.notes, Contains(AllOf(HasSubstr("hand_x"), HasSubstr("'pos_mm'"))));
  EXPECT_THAT(recording.notes, Contains(HasSubstr("'time'")));
}

TEST_F(Read, TakesANameWithBracketsBeforeAColumn) {
  EXPECT_EQ(good("time,pos[1]\n0,5\n1,5\n", with_channels("x=pos[1]")).channels.front().values[0], 5.0);
  EXPECT_THAT(bad("time,pos\n0,5\n1,5\n", with_channels("x=pos[1]")).message,
              AllOf(HasSubstr("'pos[1]'"), HasSubstr("2 columns")));
}

TEST_F(Read, SaysWhatThereIsWhereAColumnOfAMatrixIsNot) {
  const std::string bytes = header5() + double5("pos", Matrix::Zero(30, 3)) + double5("force", Matrix::Zero(29, 3));
  EXPECT_THAT(bad(bytes, with_channels("x=pos[4]")).line(),
              AllOf(HasSubstr("'pos'"), HasSubstr("channel x"), HasSubstr("column 4"), HasSubstr("30×3")));
  EXPECT_THAT(bad(bytes, with_channels("x=pos[0]")).message, HasSubstr("column 0"));
  EXPECT_THAT(bad(bytes, with_channels("x=posi[1]")).message,
              AllOf(HasSubstr("'posi'"), HasSubstr("pos (30×3)"), HasSubstr("force (29×3)")));
  EXPECT_THAT(bad(bytes, with_channels("x=pos[1],Fx=force[1]")).message,
              AllOf(HasSubstr("'pos[1]'"), HasSubstr("30 samples"), HasSubstr("'force[1]'")));
  EXPECT_THAT(bad(bytes, with_channels("x=pos")).remedy, HasSubstr("\"x=pos[1]\""));
  EXPECT_THAT(bad(bytes, with_channels("x=2")).remedy, HasSubstr("\"x=pos[2]\""));
  EXPECT_THAT(bad(bytes).remedy, HasSubstr("\"time=pos[1],x=pos[2],Fx=force[1]\""));
}

// ---- robots of other kinds, voltages ----

TEST_F(Read, KnowsJointsThatTurnAndJointsThatSlide) {
  const std::string csv = "time,q1_deg,q3_mm,q4,tau1,tau3_N,qr1,qr3_mm\n0,180,250,1,2,3,4,500\n1,0,0,0,0,0,0,0\n";
  const Recording recording = good(csv);
  for (const auto& [name, unit, value] : {std::tuple{"joint_1", "rad", M_PI},
                                          {"joint_3", "m", 0.25},
                                          {"joint_4", "rad", 1.0},
                                          {"torque_1", "N.m", 2.0},
                                          {"torque_3", "N", 3.0},
                                          {"reference_joint_1", "rad", 4.0},
                                          {"reference_joint_3", "m", 0.5}}) {
    ASSERT_NE(recording.find(name), nullptr) << name;
    EXPECT_EQ(recording.find(name)->unit, unit) << name;
    EXPECT_EQ(recording.find(name)->frame, "joint") << name;
    EXPECT_DOUBLE_EQ(recording.find(name)->values[0], value) << name;
  }
}

TEST_F(Read, KnowsVoltagesByNameAndUnitAndLeavesVelocitiesAside) {
  const Recording recording = good("time,Vx_mV,voltage_y,vy\n0,500,2,7\n1,0,0,7\n");
  EXPECT_THAT(names_of(recording), ElementsAre("voltage_x", "voltage_y"));
  EXPECT_EQ(recording.find("voltage_x")->values[0], 0.5);
  EXPECT_EQ(recording.find("voltage_x")->unit, "V");
}

// ---- the 19-row logs matrix ----

TEST_F(Read, RecognisesALogsMatrixInEveryMatVersion) {
  const Matrix values = logs(50);
  for (const std::string& bytes :
       {test::mat4("logs", values), test::mat4("logs", values, true), header5() + double5("logs", values),
        header5(true) + double5("logs", values, true), header5() + test::compressed5(double5("logs", values))}) {
    const Recording recording = good(bytes);
    EXPECT_THAT(names_of(recording),
                ElementsAre("hand_x", "hand_y", "joint_1", "joint_2", "force_x", "force_y", "reference_x",
                            "reference_y", "torque_1", "torque_2", "acceleration_x", "acceleration_y"));
    EXPECT_EQ(recording.time, values.row(0).transpose());
    for (const auto& [name, row] : {std::pair{"hand_x", 2},
                                    {"hand_y", 3},
                                    {"joint_1", 6},
                                    {"joint_2", 7},
                                    {"force_x", 10},
                                    {"force_y", 11},
                                    {"reference_x", 12},
                                    {"reference_y", 13},
                                    {"torque_1", 14},
                                    {"torque_2", 15},
                                    {"acceleration_x", 18},
                                    {"acceleration_y", 19}}) {
      EXPECT_EQ(recording.find(name)->values, values.row(row - 1).transpose()) << name;
    }
    EXPECT_EQ(recording.find("force_x")->unit, "N");
    EXPECT_EQ(recording.find("force_x")->frame, "base");
    EXPECT_EQ(recording.find("torque_1")->frame, "joint");
    EXPECT_EQ(recording.find("reference_x")->unit, "");  // m or N: the file does not say
    EXPECT_FALSE(recording.time_from_rate);
    EXPECT_EQ(recording.sources.at(0).sha256.size(), 64u);
  }
}

TEST_F(Read, TakesTheOnlyMatrixOf19RowsWhateverItsName) {
  EXPECT_EQ(good(header5() + double5("a", Matrix::Zero(2, 9)) + double5("trial7", logs(30))).samples(), 30);
}

TEST_F(Read, AsksWhichOfSeveralMatricesIsMeant) {
  const std::string two = header5() + double5("a", logs(30)) + double5("b", logs(40));
  EXPECT_EQ(bad(two).kind, ErrorKind::usage);
  EXPECT_THAT(bad(two).remedy, HasSubstr("--variable"));
  ReadOptions options;
  options.variable = "b";
  EXPECT_EQ(good(two, options).samples(), 40);
  options.variable = "c";
  EXPECT_THAT(bad(two, options).message, AllOf(HasSubstr("'c'"), HasSubstr("a (19×30)"), HasSubstr("b (19×40)")));
}

TEST_F(Read, DoesNotTransposeALogsMatrix) {
  const std::string tall = header5() + double5("logs", logs(30).transpose());
  EXPECT_THAT(bad(tall).line(), AllOf(HasSubstr("'logs'"), HasSubstr("30×19"), HasSubstr("19 rows")));
  EXPECT_THAT(bad(tall).remedy, HasSubstr("--channels"));
  EXPECT_EQ(good(tall, with_channels("time=1,x=2,Fx=10")).find("force_x")->values, logs(30).row(9).transpose());
}

TEST_F(Read, LeavesRowsThatAreNaNThroughoutAside) {
  Matrix values = logs(30);
  values.row(17).setConstant(std::nan(""));
  const Recording recording = good(header5() + double5("logs", values));
  EXPECT_EQ(recording.find("acceleration_x"), nullptr);
  EXPECT_NE(recording.find("acceleration_y"), nullptr);
  EXPECT_THAT(recording.notes, Contains(HasSubstr("acceleration_x")));
}

// ---- the channel map ----

TEST_F(Read, TakesRowsOfAWideAndColumnsOfATallMatrix) {
  const ReadOptions options = with_channels("time=1:ms,x=2:mm,Fx=-3");
  Matrix wide(3, 4);
  wide << 0, 1, 2, 3, 10, 20, 30, 153, 1, 2, 3, 4;
  for (const Matrix& values : {wide, Matrix(wide.transpose())}) {
    const Recording recording = good(header5() + double5("z", values), options);
    EXPECT_EQ(recording.time[3], 0.003);
    EXPECT_EQ(recording.find("hand_x")->values[3], 0.153);
    EXPECT_EQ(recording.find("force_x")->values[3], -4);
  }
}

TEST_F(Read, TakesVariablesAndFieldsByName) {
  const Vector t = Vector::LinSpaced(5, 0, 0.004);
  const std::string bytes = header5() + double5("qm", t * 2) +
                            struct5("log", {{"time", double5("", t)},
                                            {"signals", struct5("", {{"values", double5("", t.transpose() * 3)}})}});
  const Recording recording = good(bytes, with_channels("time=log.time,x=qm,F=log.signals.values"));
  EXPECT_EQ(recording.time, t);
  EXPECT_EQ(recording.find("position")->values, t * 2);
  EXPECT_EQ(recording.find("reaction")->values, t * 3);
}

TEST_F(Read, CountsLinesOfTheNamedField) {
  ReadOptions options = with_channels("time=log.time,x=1,F=2");
  options.variable = "log.values";
  const Vector t = Vector::LinSpaced(5, 0, 0.004);
  Matrix values(5, 2);
  values << t * 2, t * 3;
  const Recording recording =
      good(header5() + struct5("log", {{"time", double5("", t)}, {"values", double5("", values)}}), options);
  EXPECT_EQ(recording.find("reaction")->values, t * 3);
}

TEST_F(Read, NamesWhatIsNotThere) {
  EXPECT_THAT(bad("t,u\n0,1\n", with_channels("x=v")).message,
              AllOf(HasSubstr("channel x"), HasSubstr("'v'"), HasSubstr("2 columns"), HasSubstr("t, u")));
  EXPECT_THAT(bad("t,u\n0,1\n", with_channels("x=3")).message, HasSubstr("column 3"));
  EXPECT_THAT(bad("t,u\n0,1\n", with_channels("x=0")).message, HasSubstr("column 0"));
  EXPECT_THAT(bad(header5() + double5("z", logs(5)), with_channels("x=20")).message, HasSubstr("column 20"));
  EXPECT_THAT(bad(header5() + double5("z", logs(50)), with_channels("x=z")).message,
              AllOf(HasSubstr("'z'"), HasSubstr("19×50")));
}

TEST_F(Read, RefusesAUnitThatTheChannelOfThatManyAxesCannotHave) {
  EXPECT_THAT(bad("t,u,v\n0,1,2\n", with_channels("time=t,x=u:rad,y=v")).message,
              AllOf(HasSubstr("hand_x"), HasSubstr("'rad'")));
  EXPECT_EQ(good("t,u,v\n0,1,2\n", with_channels("time=t,x=u:rad,F=v:N.m")).find("position")->unit, "rad");
}

TEST_F(Read, RefusesLengthsThatDiffer) {
  const std::string bytes =
      header5() + double5("t", Vector::LinSpaced(5, 0, 1)) + double5("x", Vector::LinSpaced(6, 0, 1));
  EXPECT_THAT(bad(bytes).message, AllOf(HasSubstr("'t'"), HasSubstr("5 samples"), HasSubstr("'x'")));
}

// ---- names ----

TEST_F(Read, RecognisesNamesAliasesAndUnitSuffixes) {
  const Recording recording =
      good("t_ms,Hand_X_mm,y [cm],FX,Fy (mN),q1_deg,temperature\n0,153,2,3,4,180,9\n1,154,2,3,4,180,9\n");
  EXPECT_THAT(names_of(recording), ElementsAre("hand_x", "hand_y", "force_x", "force_y", "joint_1"));
  EXPECT_EQ(recording.time[1], 0.001);
  EXPECT_EQ(recording.find("hand_x")->values[0], 0.153);
  EXPECT_EQ(recording.find("hand_y")->values[0], 0.02);
  EXPECT_EQ(recording.find("force_y")->values[0], 0.004);
  EXPECT_EQ(recording.find("joint_1")->values[0], M_PI);
  EXPECT_THAT(recording.notes, Contains(HasSubstr("temperature")));
}

TEST_F(Read, TakesXForOneAxisWhereTheOtherNamesSaySo) {
  EXPECT_THAT(names_of(good("t,x,F,xr\n0,1,2,3\n1,1,2,3\n")), ElementsAre("position", "reaction", "reference"));
  EXPECT_THAT(names_of(good("t,x,Fx,xr\n0,1,2,3\n1,1,2,3\n")), ElementsAre("hand_x", "force_x", "reference_x"));
  ReadOptions options;
  options.axes = 1;
  EXPECT_THAT(names_of(good("t,x\n0,1\n1,1\n", options)), ElementsAre("position"));
  options.axes = 4;
  EXPECT_EQ(bad("t,x\n0,1\n1,1\n", options).kind, ErrorKind::usage);
}

TEST_F(Read, TakesThreeAxesWhereTheyAreAskedFor) {
  const std::string csv = "t,x_mm,y_mm,z_mm,Fx,Fy,Fz,zr_mm,az\n0,1,2,3,4,5,6,7,8\n1,1,2,3,4,5,6,7,8\n";
  ReadOptions options;
  options.axes = 3;
  const Recording recording = good(csv, options);
  EXPECT_THAT(names_of(recording), ElementsAre("hand_x", "hand_y", "hand_z", "force_x", "force_y", "force_z",
                                               "reference_z", "acceleration_z"));
  EXPECT_EQ(recording.find("hand_z")->values[0], 0.003);
  EXPECT_EQ(recording.find("hand_z")->frame, "base");
  EXPECT_EQ(recording.find("reference_z")->unit, "m");

  ReadOptions mapped = with_channels("x=2,y=3,z=4,Fx=5,Fy=6,Fz=-7,zr=8");
  const std::string numbered = "0,1,2,3,4,5,6,7\n1,1,2,3,4,5,6,7\n";
  for (const int axes : {0, 3}) {
    mapped.axes = axes;
    mapped.rate = Hertz(1.0);
    const Recording by_map = good(numbered, mapped);
    EXPECT_EQ(by_map.find("force_z")->values[0], -6.0) << axes;
    EXPECT_EQ(by_map.find("reference_z")->values[0], 7.0) << axes;
  }
}

TEST_F(Read, IgnoresAThirdAxisThatNobodyAskedFor) {
  // Columns that are called z, Fz and az only by chance: without units, in other units, twice, or of words.
  for (const std::string_view csv : {
           "t,x,y,Fx,Fy,z,Fz,az\n0,1,2,3,4,5,6,7\n1,1,2,3,4,5,6,7\n",
           "t,x,y,Fx,Fy,z,Fz,az\ns,m,m,N,N,V,deg,V\n0,1,2,3,4,5,6,7\n1,1,2,3,4,5,6,7\n",
           "t,x,y,Fx,Fy,hand_z (V),force_z,Fz\n0,1,2,3,4,5,6,7\n1,1,2,3,4,5,6,7\n",
           "t,x,y,Fx,Fy,z,Fz,force_z\n0,1,2,3,4,up,down,7\n1,1,2,3,4,up,up,7\n",
       }) {
    for (const int axes : {0, 2}) {
      ReadOptions options;
      options.axes = axes;
      const Recording recording = good(csv, options);
      EXPECT_THAT(names_of(recording), ElementsAre("hand_x", "hand_y", "force_x", "force_y")) << csv;
      EXPECT_THAT(recording.notes, Contains(AllOf(HasSubstr("ignored"), HasSubstr("Fz")))) << csv;
    }
  }
  EXPECT_THAT(names_of(good("t,x,F,z\n0,1,2,3\n1,1,2,3\n")), ElementsAre("position", "reaction"));
  ReadOptions three;
  three.axes = 3;
  EXPECT_THAT(bad("t,x,Fx,z\ns,m,N,V\n0,1,2,3\n1,1,2,3\n", three).message,
              AllOf(HasSubstr("'z'"), HasSubstr("'V'"), HasSubstr("hand_z")));
}

TEST_F(Read, TakesAThirdAxisThatTheFileHasInFull) {
  const std::string csv = "time_s,hand_x_m,hand_y_m,hand_z_m,force_x_N,force_y_N,force_z_N,reference_z (V)\n";
  const std::string rows = "0,1,2,3,4,5,6,7\n1,1,2,3,4,5,6,7\n";
  EXPECT_THAT(names_of(good(csv + rows)),
              testing::UnorderedElementsAre("hand_x", "hand_y", "hand_z", "force_x", "force_y", "force_z"));
  ReadOptions options;
  options.axes = 2;
  EXPECT_THAT(names_of(good(csv + rows, options)), ElementsAre("hand_x", "hand_y", "force_x", "force_y"));
  options = {};
  options.requested = {"hand_x", "hand_z"};
  EXPECT_THAT(names_of(good(csv + rows, options)), ElementsAre("hand_x", "hand_z"));
}

TEST_F(Read, LeavesTheUnitOpenWhereItIsNotSaid) {
  EXPECT_EQ(good("t,x,F\n0,1,2\n").find("position")->unit, "");
  EXPECT_EQ(good("t,position_rad,reaction_Nm\n0,1,2\n").find("reaction")->unit, "N.m");
}

TEST_F(Read, BelievesTheUnitInANamedColumnAndSaysSo) {
  const Recording recording = good("t,pos_mm,signal_in\n0,153,7\n", with_channels("t=t,y=pos_mm,x=signal_in"));
  EXPECT_EQ(recording.find("hand_y")->values[0], 0.153);
  EXPECT_EQ(recording.find("hand_x")->values[0], 7);  // an input, not inches
  EXPECT_THAT(recording.notes, Contains(AllOf(HasSubstr("hand_y"), HasSubstr("'pos_mm'"))));
}

TEST_F(Read, RefusesTwoColumnsForOneChannel) {
  EXPECT_THAT(bad("t,x,hand_x\n0,1,2\n").message, AllOf(HasSubstr("'x'"), HasSubstr("'hand_x'")));
}

TEST_F(Read, OffersTheNumbersOfARepeatedName) {
  const std::string csv = "time_s,hand_x,hand_y,force_x,force_y,force_x\n0,1,2,3,4,5\n0.1,1,2,3,4,6\n";
  const std::string sto =
      "a\nendheader\ntime_s\thand_x\thand_y\tforce_x\tforce_y\tforce_x\n0\t1\t2\t3\t4\t5\n0.1\t1\t2\t3\t4\t6\n";
  for (const std::string& text : {csv, sto}) {
    EXPECT_THAT(bad(text).line(), AllOf(HasSubstr("'force_x'"), HasSubstr("column 4"), HasSubstr("column 6"),
                                        HasSubstr("--channels t=1:s,x=2,y=3,Fx=4,Fy=5"), HasSubstr("Fx=6")));
    EXPECT_THAT(bad(text, with_channels("time=time_s,x=hand_x:mm,Fx=-force_x")).line(),
                AllOf(HasSubstr("'force_x'"), HasSubstr("--channels time=time_s,x=hand_x:mm,force_x=-4"),
                      HasSubstr("force_x=6")));
    EXPECT_THAT(bad(text, with_channels("Fx=force_x*2+1")).remedy, HasSubstr("force_x=6"));
    EXPECT_EQ(good(text, with_channels("x=2,Fx=6")).find("force_x")->values[1], 6);
  }
  const Recording same = good("t,x,F,F\n0,1,2,2\n0.1,2,3,3\n", with_channels("x=x,F=F"));
  EXPECT_EQ(same.find("reaction")->values[1], 3);
  EXPECT_THAT(bad("t,x,F,F\n0,1,2,2\n0.1,2,3,word\n", with_channels("x=x,F=F")).line(),
              AllOf(HasSubstr("'F'"), HasSubstr("=4")));
}

TEST_F(Read, OffersTheNumbersOfTwoTimes) {
  EXPECT_THAT(bad("time,x,time,F\n0,1,0,2\n1,1,2,3\n", with_channels("x=x,F=F")).line(),
              AllOf(HasSubstr("column 1"), HasSubstr("column 3"), HasSubstr("time=1"), HasSubstr("time=3")));
  EXPECT_EQ(good("time,x,time,F\n0,1,0,2\n1,1,1,3\n", with_channels("x=x,F=F")).time[1], 1.0);
}

TEST_F(Read, TakesTheUnitOfANameHoweverItIsWritten) {
  for (const char* name : {"hand_x [mm]", "hand_x (Millimeters)", "hand_x_mm", "hand_x mm", "hand_x in mm",
                           "hand_x, mm", "hand_x/mm", "hand_x / mm"}) {
    const std::string text = "t\t" + std::string(name) + "\tFx\n0\t153\t1\n1\t153\t1\n";
    EXPECT_EQ(good(text).find("hand_x")->values[0], 0.153) << name;
    EXPECT_EQ(good(text, with_channels("y=2")).find("hand_y")->values[0], 0.153) << name;
  }
  for (const char* name : {"hand m", "plate N", "Sensor in", "a b c", "sent in, hand"}) {
    EXPECT_EQ(parse_column_name(name).unit, nullptr) << name;
  }
  EXPECT_EQ(parse_column_name("acc m/s2").unit->name, "m/s2");
  EXPECT_EQ(parse_column_name("time in s").kinds.size(), 1U);
}

TEST_F(Read, NamesAUnitInTheNameThatTheChannelCannotHave) {
  const std::string text = "t,x,cell [V]\n0,1,2\n1,2,3\n";
  EXPECT_THAT(good(text, with_channels("x=x,Fx=3")).notes,
              Contains(AllOf(HasSubstr("'cell [V]'"), HasSubstr("force_x"))));
  EXPECT_THAT(good(text, with_channels("x=x,Fx=3:N")).notes, testing::Each(testing::Not(HasSubstr("'cell [V]'"))));
}

TEST_F(Read, TakesNoCurrentForATorque) {
  for (const char* name :
       {"i1 [A]", "motor (mA)", "motor_mA", "current_1", "MotorCurrent", "Iq_1", "i_motor", "curr 1"}) {
    const std::string text = "t,q1," + std::string(name) + "\n0,1,2\n1,2,3\n";
    for (const std::string& source : {std::string(name), std::string("3")}) {
      EXPECT_THAT(bad(text, with_channels("q1=2,tau1=" + source)).line(),
                  AllOf(HasSubstr("current"), HasSubstr("*0.12:N.m")))
          << name;
      EXPECT_EQ(good(text, with_channels("q1=2,tau1=" + source + "*0.5:N.m")).find("torque_1")->values[0], 1.0) << name;
      EXPECT_EQ(good(text, with_channels("q1=2,tau1=" + source + ":N.m")).find("torque_1")->values[0], 2.0) << name;
    }
  }
  for (const char* name :
       {"current_torque", "actual_current_force", "motor_A", "torque", "index", "column 3", "amplitude"}) {
    const std::string text = "t,q1," + std::string(name) + "\n0,1,2\n1,2,3\n";
    EXPECT_EQ(good(text, with_channels("q1=2,tau1=3")).find("torque_1")->values[0], 2.0) << name;
  }
}

TEST_F(Read, ListsTheColumnsWhereNothingIsRecognised) {
  EXPECT_THAT(bad("u,v\n0,1\n").line(),
              AllOf(HasSubstr("channel"), HasSubstr("2 columns"), HasSubstr("u, v"), HasSubstr("--channels")));
  EXPECT_THAT(bad("time,b\n0,1\n").message, AllOf(HasSubstr("2 columns"), HasSubstr("time, b")));
  EXPECT_THAT(bad("0,1\n1,2\n").message, AllOf(HasSubstr("2 columns"), HasSubstr("name")));
}

// ---- time ----

TEST_F(Read, FindsTheTimeByItsNameWhereTheMapLeavesItOut) {
  ReadOptions options;
  options.channels = parse_channel_map("x=angle:deg,F=torque_Nm").value();
  const Recording recording = good("t_ms,angle,torque_Nm\n0,180,1\n1,90,2\n", options);
  EXPECT_DOUBLE_EQ(recording.time[1], 0.001);
  EXPECT_FALSE(recording.time_from_rate);
}

TEST_F(Read, NeedsARateWhereThereIsNoTime) {
  EXPECT_EQ(bad("x\n1\n2\n3\n").kind, ErrorKind::data);
  EXPECT_THAT(bad("x\n1\n2\n3\n").remedy, HasSubstr("--rate"));
  ReadOptions options;
  options.rate = Hertz(500);
  const Recording recording = good("x\n1\n2\n3\n", options);
  EXPECT_TRUE(recording.time_from_rate);
  EXPECT_EQ(recording.time, (Vector(3) << 0, 0.002, 0.004).finished());
}

TEST_F(Read, RefusesARateThatContradictsTheTime) {
  ReadOptions options;
  options.rate = Hertz(500);
  EXPECT_EQ(bad("t,x\n0,1\n0.001,2\n0.002,3\n", options).kind, ErrorKind::usage);
  options.rate = Hertz(1000);
  EXPECT_FALSE(good("t,x\n0,1\n0.001,2\n0.002,3\n", options).time_from_rate);
  for (const double rate : {0.0, -5.0, std::nan(""), HUGE_VAL}) {
    options.rate = Hertz(rate);
    EXPECT_EQ(bad("x\n1\n2\n", options).kind, ErrorKind::usage) << rate;
  }
}

TEST_F(Read, KeepsTimeAsItWasRecorded) {
  const Recording recording = good("t,x\n1700000000.5,1\n1700000000.4,2\n1700000000.4,nan\n");
  EXPECT_EQ(recording.time, (Vector(3) << 1700000000.5, 1700000000.4, 1700000000.4).finished());
  EXPECT_EQ(inspect(recording).backward_times, 1);
  EXPECT_EQ(inspect(recording).non_finite.at(0).first, 2);
}

// ---- rates and units that the file says ----

/// Two points at 100 Hz, channels at 200 Hz.
TEST_F(Read, MakesTheTimeFromTheRateThatTheFileSays) {
  const std::string file = test::small_c3d().bytes();
  const Recording points = good(file, with_channels("x=HAND.x,y=HAND.y"));
  EXPECT_TRUE(points.time_from_rate);
  EXPECT_EQ(points.samples(), 6);
  EXPECT_EQ(points.time[5], 0.05);
  const Recording channels = good(file, with_channels("Fx=Force X,q1=Angle"));
  EXPECT_EQ(channels.samples(), 12);
  EXPECT_EQ(channels.time[10], 0.05);
  EXPECT_EQ(channels.events.size(), 2u);
}

TEST_F(Read, RefusesARateThatContradictsTheFilesOwn) {
  ReadOptions options = with_channels("Fx=Force X");
  options.rate = Hertz(100);
  EXPECT_THAT(bad(test::small_c3d().bytes(), options).line(),
              AllOf(HasSubstr("100 Hz"), HasSubstr("200 Hz"), HasSubstr("--rate")));
  options.rate = Hertz(200);
  EXPECT_EQ(good(test::small_c3d().bytes(), options).time[1], 0.005);
}

TEST_F(Read, RefusesChannelsOfDifferentRatesAndSaysWhatToDo) {
  const Error error = bad(test::small_c3d().bytes(), with_channels("x=HAND.x,Fx=Force X"));
  EXPECT_THAT(error.message,
              AllOf(HasSubstr("'HAND.x'"), HasSubstr("100 Hz"), HasSubstr("'Force X'"), HasSubstr("200 Hz")));
  EXPECT_THAT(error.remedy, HasSubstr("force_x=Force X@100"));
}

TEST_F(Read, TakesEveryKthSampleWhereItIsAsked) {
  const Recording recording = good(test::small_c3d().bytes(), with_channels("x=HAND.x,Fx=-Force X@100:kN"));
  const Recording whole = good(test::small_c3d().bytes(), with_channels("Fx=Force X"));
  ASSERT_EQ(recording.samples(), 6);
  for (Index k = 0; k < 6; ++k) {
    EXPECT_EQ(recording.find("force_x")->values[k], -1e3 * whole.find("force_x")->values[2 * k]);
  }
  EXPECT_THAT(recording.notes, Contains(AllOf(HasSubstr("force_x"), HasSubstr("2nd"), HasSubstr("'Force X'"))));
}

TEST_F(Read, ThinsOnlyByWholeNumbersAndWhereTheFileSaysTheRate) {
  const std::string file = test::small_c3d().bytes();
  EXPECT_THAT(bad(file, with_channels("Fx=Force X@60")).message, HasSubstr("'60'"));
  EXPECT_THAT(bad(file, with_channels("Fx=Force X@400")).message, HasSubstr("'400'"));
  EXPECT_THAT(bad(file, with_channels("Fx=Force X@")).message, AllOf(HasSubstr("'Force X'"), HasSubstr("''")));
  EXPECT_THAT(bad(file, with_channels("Fx=none@100")).message, HasSubstr("'none'"));
  EXPECT_THAT(bad("t,Fx\n0,1\n1,2\n", with_channels("Fx=Fx@1")).message, AllOf(HasSubstr("rate"), HasSubstr("'Fx'")));
  EXPECT_EQ(good("t,Fx@1\n0,1\n1,2\n", with_channels("Fx=Fx@1")).samples(), 2);  // a name goes before
}

TEST_F(Read, TheMapsUnitGoesBeforeTheFilesAndThatBeforeTheNames) {
  test::C3d file = test::small_c3d();
  file.channels = {"F_kN", "Angle", "EMG"};
  const auto force = [&](std::string_view map) {
    return good(file.bytes(), with_channels(map)).find("force_x")->values[11];
  };
  const double stored = (121 - 2048) * 0.25;
  EXPECT_EQ(force("Fx=F_kN:mN"), stored / 1e3);
  EXPECT_EQ(force("Fx=F_kN"), stored);
  file.analog_units[0] = "";
  EXPECT_EQ(force("Fx=F_kN"), stored * 1e3);
  const Recording angle = good(file.bytes(), with_channels("q1=Angle"));
  EXPECT_DOUBLE_EQ(angle.find("joint_1")->values[1], (100.0 + 1.0) * 0.5 * M_PI / 180.0);
}

TEST_F(Read, RefusesAUnitOfTheFileThatIsUnknownOrOfAnotherDimensionUntilTheMapSaysOne) {
  const std::string file = test::small_c3d().bytes();
  for (const char* source : {"EMG", "Angle"}) {
    const Error error = bad(file, with_channels(std::string("Fx=") + source));
    EXPECT_THAT(error.message, AllOf(HasSubstr("force_x"), HasSubstr("'" + std::string(source) + "'")));
    EXPECT_THAT(error.remedy, HasSubstr(std::string("force_x=") + source + ":UNIT"));
    EXPECT_EQ(good(file, with_channels(std::string("Fx=") + source + ":N")).find("force_x")->unit, "N");
  }
}

TEST_F(Read, AsksWhichOfSeveralColumnsOfOneLabelIsMeant) {
  test::C3d file = test::small_c3d();
  file.points = {"HAND", "HAND"};
  file.channels = {"Fx", "EMG", "Fx"};
  file.analog_units = {"N", "", "N"};
  const Error error = bad(file.bytes(), with_channels("Fx=Fx"));
  EXPECT_THAT(error.message, AllOf(HasSubstr("'Fx'"), HasSubstr("'Fx#1'"), HasSubstr("column 7"), HasSubstr("'Fx#2'"),
                                   HasSubstr("column 9")));
  EXPECT_THAT(bad(file.bytes(), with_channels("x=HAND.x")).message,
              AllOf(HasSubstr("'HAND#2.x'"), HasSubstr("column 4")));
  EXPECT_THAT(bad(file.bytes()).message, AllOf(HasSubstr("channel"), HasSubstr("9 columns")));
  EXPECT_EQ(good(file.bytes(), with_channels("Fx=Fx#2")).find("force_x")->values[0],
            good(file.bytes(), with_channels("Fx=9")).find("force_x")->values[0]);
}

TEST_F(Read, NamesMayHoldColons) {
  test::C3d file = test::small_c3d();
  file.points = {"Arm:HAND", "Arm:m"};
  const Recording recording = good(file.bytes(), with_channels("x=Arm:HAND.x,y=Arm:HAND.y:cm"));
  EXPECT_EQ(recording.find("hand_x")->values[1], 0.5 / 1e3);
  EXPECT_EQ(recording.find("hand_y")->values[1], (1.0 - 7.0) * 0.5 / 1e2);
  file.channels[0] = "Arm:N";
  EXPECT_EQ(good(file.bytes(), with_channels("Fx=Arm:N")).samples(), 12);
  EXPECT_THAT(bad("t,y\n0,1\n", with_channels("y=2:counts")).message, HasSubstr("'counts'"));
  EXPECT_THAT(bad("t,y\n0,1\n", with_channels("y=z:counts")).message, HasSubstr("'z:counts'"));
}

// ---- files ----

TEST_F(Read, DecidesByContentNotByName) {
  EXPECT_TRUE(read(folder_.write("log.mat", "t,x\n0,1\n"), {}));
  EXPECT_TRUE(read(folder_.write("log.csv", header5() + double5("logs", logs(30))), {}));
}

TEST_F(Read, RefusesWhatIsNotARecording) {
  EXPECT_THAT(bad("").message, HasSubstr("empty"));
  EXPECT_THAT(bad(std::string("\x7f\x46LF\x02\x01\x01\0\0\0", 10)).line(), HasSubstr("7f 46"));
  EXPECT_THAT(bad("\x89HDF\r\n\x1a\n....").message, HasSubstr("HDF5"));
  EXPECT_THAT(bad(std::string("\x02\x50") + std::string(600, '\0')).message, HasSubstr("C3D"));
  EXPECT_THAT(bad(header5()).message, AllOf(HasSubstr("channel"), HasSubstr("variable")));
  EXPECT_THAT(bad("Dear reader,\nthis is a letter.\n").message, HasSubstr("'this is a letter.'"));
}

TEST_F(Read, RefusesWhatCannotBeOpened) {
  EXPECT_THAT(read(folder_ / "none.mat", {}).error().where, HasSubstr("none.mat"));
  EXPECT_THAT(read(folder_ / "", {}).error().message, HasSubstr("folder"));
  ASSERT_EQ(::mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  EXPECT_THAT(read(folder_ / "pipe", {}).error().message, HasSubstr("regular file"));
  EXPECT_EQ(read(folder_ / "none.mat", {}).error().kind, ErrorKind::data);
}

TEST_F(Read, RefusesAnUnreadableFile) {
  if (::geteuid() == 0) GTEST_SKIP() << "everything is readable to root";
  const auto file = folder_.write("secret", "t,x\n0,1\n");
  std::filesystem::permissions(file, std::filesystem::perms::none);
  EXPECT_THAT(read(file, {}).error().message, HasSubstr("Permission denied"));
}

TEST_F(Read, RefusesAFileAboveTheLimitBeforeReadingIt) {
  std::filesystem::resize_file(folder_.write("large", "x"), (std::uintmax_t{8} << 30) + 1);  // sparse
  EXPECT_THAT(read(folder_ / "large", {}).error().message, HasSubstr("8589934593"));
}

// ---- real files ----

TEST(ReadRealFiles, LogsOfTheStudy) {
  MBK_DATA_OR_SKIP(data);
  for (const auto& [name, samples] : {std::pair{"golden/sinusoidal.mat", 64000}, {"golden/underdamped.mat", 120784}}) {
    const auto recording = read(data / name, {});
    ASSERT_TRUE(recording) << recording.error().line();
    EXPECT_EQ(recording->samples(), samples);
    EXPECT_EQ(recording->channels.size(), 12u);
    EXPECT_NEAR(inspect(*recording).rate_hz, 1000.0, 1e-6);
  }
}

TEST(ReadRealFiles, AnkleBothAsTableAndAsMatrixBesideObjects) {
  MBK_DATA_OR_SKIP(data);
  const auto table = read(data / "ankle/z_df.csv", with_channels("time=time_s,x=position_rad,F=torque_Nm"));
  ASSERT_TRUE(table) << table.error().line();
  EXPECT_EQ(table->samples(), 60000);
  EXPECT_EQ(table->find("position")->unit, "rad");
  EXPECT_EQ(table->find("reaction")->unit, "N.m");

  ReadOptions options = with_channels("x=1:rad,F=2:N.m");
  options.rate = Hertz(1000);
  const auto matrix = read(data / "ankle/z.mat", options);
  ASSERT_TRUE(matrix) << matrix.error().line();
  EXPECT_THAT(matrix->notes, Contains(AllOf(HasSubstr("'z_df'"), HasSubstr("'nldat'"))));
  // The table was written with seven significant digits of the torque, eight decimals of the angle.
  EXPECT_LT((matrix->find("position")->values - table->find("position")->values).cwiseAbs().maxCoeff(), 0.6e-8);
  EXPECT_LT((matrix->find("reaction")->values - table->find("reaction")->values).cwiseAbs().maxCoeff(), 0.6e-5);
}

TEST(ReadAnySignal, InputAndOutputAreTakenOnlyWhereAsked) {
  const test::Folder folder;
  const auto file = folder.write("plant.csv", "time,x,Input,output [mm]\n0,1,5,7\n0.1,2,6,8\n");
  const auto by_name = read(file, {});
  ASSERT_TRUE(by_name) << by_name.error().line();
  EXPECT_EQ(by_name->channels.size(), 1U);
  const auto mapped = read(file, with_channels("input=Input:V,output=output [mm]"));
  ASSERT_TRUE(mapped) << mapped.error().line();
  EXPECT_EQ(mapped->find("input")->unit, "V");
  EXPECT_EQ(mapped->find("output")->unit, "m");
  EXPECT_DOUBLE_EQ(mapped->find("output")->values[1], 0.008);
}

TEST(ReadAnySignal, ExpectedChannelsAreTakenByNameBesideTheMap) {
  const test::Folder folder;
  const auto file = folder.write("plant.csv", "time,hand_x_mm,Fx,7\n0,1,5,7\n0.1,2,6,8\n");
  ReadOptions options = with_channels("output=4");
  options.requested = {"x"};
  const auto both = read(file, options);
  ASSERT_TRUE(both) << both.error().line();
  EXPECT_EQ(both->channels.size(), 2U);
  EXPECT_DOUBLE_EQ(both->find("hand_x")->values[1], 0.002);
  EXPECT_DOUBLE_EQ(both->find("output")->values[1], 8.0);
}

TEST(ReadRealFiles, DriveAndFlexibleArm) {
  MBK_DATA_OR_SKIP(data);
  const auto drive = read(data / "emps/DATA_EMPS.mat", with_channels("t=t,x=qm:m,F=vir,xr=qg:m"));
  ASSERT_TRUE(drive) << drive.error().line();
  EXPECT_EQ(drive->samples(), 24841);
  EXPECT_NEAR(inspect(*drive).rate_hz, 1000.0, 0.05);
  ReadOptions options = with_channels("F=Input,a=Output");
  options.rate = Hertz(500);
  const auto arm = read(data / "flexible_arm/contsid_robotarm.mat", options);
  ASSERT_TRUE(arm) << arm.error().line();
  EXPECT_EQ(arm->samples(), 40960);
}

TEST(ReadRealFiles, EveryMatFileIsReadOrRefusedInOneLine) {
  MBK_DATA_OR_SKIP(data);
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(data / "mat")) {
    if (entry.path().extension() != ".mat") continue;
    ++files;
    const auto recording = read(entry.path(), {});
    ASSERT_FALSE(recording) << entry.path();  // none holds named channels
    const std::string line = recording.error().line();
    EXPECT_EQ(line.find('\n'), line.npos) << line;
    EXPECT_THAT(line, HasSubstr(entry.path().filename().string()));
    EXPECT_LT(line.size(), 900u) << line;
  }
  EXPECT_GT(files, 0);
}

TEST(ReadRealFiles, MatricesOfEveryVersionHoldTheSameNumbers) {
  MBK_DATA_OR_SKIP(data);
  ReadOptions options = with_channels("x=1,y=2");
  options.rate = Hertz(1);
  for (const char* name : {"testmatrix_4.2c_SOL2", "testmatrix_6.1_SOL2", "testmatrix_7.1_GLNX86"}) {
    const auto recording = read(data / "mat" / (std::string(name) + ".mat"), options);
    ASSERT_TRUE(recording) << recording.error().line();
    EXPECT_EQ(recording->find("hand_x")->values, Vector::LinSpaced(5, 1, 5)) << name;
  }
}

TEST(ListContents, ShowsWhatIsThereUnderItsOwnNames) {
  const test::Folder folder;
  const auto contents = list_contents(*open(folder.write("trial.csv", "u,v\n1,nan\n-3,5\n")).value());
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_TRUE(contents->table);
  ASSERT_EQ(contents->arrays.size(), 2u);
  EXPECT_EQ(contents->arrays[0].name, "u");
  EXPECT_EQ(contents->arrays[0].rows, 2);
  EXPECT_EQ(contents->arrays[0].minimum, -3.0);
  EXPECT_EQ(contents->arrays[1].minimum, 5.0);  // NaN is left out
  EXPECT_FALSE(open(folder / "none.csv"));
}

TEST(ReadRealFiles, AKneeAsAnalogChannels) {
  MBK_DATA_OR_SKIP(folder);
  const auto file = folder / "c3d" / "Sample35_isokinetic_EMG_angle_torque.c3d";
  ReadOptions options;
  options.axes = 1;
  options.channels = {{"x", "Angle"}, {"F", "Torque"}};
  const auto recording = recording::read(file, options);
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_EQ(recording->samples(), 29 * 1250);
  EXPECT_EQ(recording->time[1250], 1.0);
  EXPECT_EQ(recording->find("position")->unit, "rad");
  EXPECT_EQ(recording->find("reaction")->unit, "N.m");
}

}  // namespace
}  // namespace mbk::recording
