# Seconds that the longest tests take beside others on two processors, for a machine where they have not run yet: ctest
# starts with what costs most, so that nothing long is left alone at the end. What has run is measured in
# Testing/Temporary/CTestCostData.txt of the build folder, from which this list is renewed.
#
# The browser's tests and robots in real time wait for each other (RESOURCE_LOCK) and clang-tidy takes all processors: they
# begin before all else, and what mostly waits begins later than its time asks for, as their own COST says. CTest reads
# this file after the tests that it names; a name that is no test is passed over.
set(costs
    109 install
    40 instructions
    75 package/lintian
    66 end_to_end/statements
    53 validation_test/Coverage.NominalNinetyFivePercentIntervalsHoldTheTruthThatOften
    47 documents/site
    47 end_to_end/robot_identify
    46 end_to_end/explore
    44 end_to_end/kill
    41 end_to_end/ramp_and_hold
    40 end_to_end/udp
    39 end_to_end/mistakes
    39 end_to_end/reproduce
    35 package/debian_packages
    35 validation_test/OneDimensional.NoLinearModelHoldsForAnArmThatCorrectsAndOneDoesWhereItDoesNot
    34 end_to_end/advice
    34 python/twins
    33 validation_test/Participant.ThreeArmsBehaveAsPeopleDid
    32 end_to_end/simulate
    32 validation_test/ClosedLoopStudy.IsTheSameOnAnyNumberOfThreads
    30 end_to_end/run
    30 python/package
    29 validation_test/MisspecificationStudy.WarnsWhereTheModelDoesNotHoldAndIsSilentWhereItDoes
    26 validation_test/AfterOnsetStudy.RefutesNothingInARun
    22 end_to_end/options
    21 end_to_end/console_floods
    21 measurement_test/IdentifyRobot.AccusesNoHonestDriveOfBendingPlayOrStickingFriction
    21 validation_test/Faults.SwitchTheMotorsOffInTime
    20 faults/nth_call
    18 end_to_end/study
    16 end_to_end/completion
    15 end_to_end/terminal
    15 measurement_test/IdentifyRobot.FindsDrivesThatBend
    15 measurement_test/IdentifyRobot.FindsDrivesWithPlay
    15 python/notebooks
    15 python/wheel
    14 bindings/python
    14 end_to_end/convert
    14 end_to_end/round_trip
    13 bench/against
    12 end_to_end/measure
    12 end_to_end/passivity
    12 faults/power_cut
    12 thesis_test/Questions.AnActiveAnswerIsDecidedByTheEnergy
    12 thesis_test/VirtualSensorExhibits.ErrMoreWithoutCoulombFrictionInTheModel
    12 validation_test/Recovery.ARelaxedArmInTheClosedLoopIsFoundWithoutMuchBias
    11 end_to_end/memory
    11 end_to_end/recover
    11 end_to_end/teleop
    11 identify_test/NearestConsistent.AgreesWithTheBarrierMethod
    11 reference_test/NoiseFree.GivesTheTruthOfPulsesUpToTheSmoothing
    11 validation_test/ClosedLoopStudy.FindsThatLeastSquaresCallsAPassiveArmActiveAndInstrumentsAndEnergyDoNot
    11 validation_test/VirtualSensorStudy.FindsForceStiffnessAndMassWithoutASensorAndWorseWithoutFriction
    10 end_to_end/manual
    10 end_to_end/misbehaving_robot
    10 end_to_end/tf
    10 python/types
    10 teleop_test/AdmissibleSet.AgreesWithDecisionsOfSingleValues
    10 thesis_test/ApparatusExhibits.FindTheRobotAndWhatFrictionIsTakenForWithoutCoulomb
    10 thesis_test/VirtualSensorExhibits.FindTheRelaxedArmByBothMethods
    9 bindings/octave
    9 thesis_test/Reproduce.ComputesTheSameOnAnyNumberOfThreads
    9 validation_test/ReflexStudy.RefutesNothingInAFewRuns
    9 validation_test/Springs.RigsOfBothTablesAreFound
    8 calibration_test/SpringConstantFit.StandardErrorsHoldTheTruthAsOftenAsTheySay
    8 end_to_end/reaching
    8 end_to_end/report
    8 end_to_end/robot_force
    8 end_to_end/servo_displacement
    8 identify_test/PredictionError.BoxJenkinsIsSharperThanOutputErrorInColouredNoise
    8 validation_test/LiveEstimate.ItsIntervalsHoldTheTruth
    8 validation_test/RobotStudy.IsTheSameOnAnyNumberOfThreads)
while(costs)
  list(POP_FRONT costs seconds name)
  set_tests_properties(${name} PROPERTIES COST ${seconds})
endwhile()
