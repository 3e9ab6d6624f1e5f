function [result, info] = passivity(varargin)
% mbk.passivity  What energy the limb absorbed, and what its model predicts.
%
%   RESULT = mbk.passivity(...) is the document that 'mbk passivity --json' writes, as a struct with every digit.
%   [RESULT, INFO] = mbk.passivity(...) also gives INFO.text, that document itself, INFO.exit_code (0: fine,
%   4: computed, but not usable), INFO.warnings (code, message) and INFO.messages.
%
%   [...] = mbk.passivity(FILE)                   the name of a file, or a cell of several
%   [...] = mbk.passivity(T, X, F)                time in s, position in m (rad), force in N (N.m): columns, one axis
%                                           or two
%   [...] = mbk.passivity(T, X, F, XR)            with the reference of the perturbation; then perhaps acceleration
%   [...] = mbk.passivity(DATA)                   a struct of signals (time, x, Fx, ...), a 19 x N logs matrix, a table,
%                                           a timetable or iddata; units as the field units, or the table, says
%   [...] = mbk.passivity(..., NAME, VALUE, ...)  options of 'mbk passivity' on the command line, as in
%                                           'mode', 'reference', 'cutoff', 5; flags take true
%
%   [...] = mbk.passivity(INFO)  of a result: the second output of mbk.measure
%
%   Errors are mbk:usage, mbk:data and mbk:not_usable; warnings are mbk:CODE, with _ for -.
%   See also mbk.measure, mbk.teleop
  [result, info] = mbk.internal.run('passivity', varargin);
end
