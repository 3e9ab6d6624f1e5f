function [result, info] = tf(varargin)
% mbk.tf  Transfer function of one input and one output.
%
%   RESULT = mbk.tf(...) is the document that 'mbk tf --json' writes, as a struct with every digit.
%   [RESULT, INFO] = mbk.tf(...) also gives INFO.text, that document itself, INFO.exit_code (0: fine,
%   4: computed, but not usable), INFO.warnings (code, message) and INFO.messages.
%
%   [...] = mbk.tf(FILE)                   the name of a file, or a cell of several
%   [...] = mbk.tf(T, X, F)                time in s, position in m (rad), force in N (N.m): columns, one axis
%                                           or two
%   [...] = mbk.tf(T, X, F, XR)            with the reference of the perturbation; then perhaps acceleration
%   [...] = mbk.tf(DATA)                   a struct of signals (time, x, Fx, ...), a 19 x N logs matrix, a table,
%                                           a timetable or iddata; units as the field units, or the table, says
%   [...] = mbk.tf(..., NAME, VALUE, ...)  options of 'mbk tf' on the command line, as in
%                                           'mode', 'reference', 'cutoff', 5; flags take true
%
%   Example
%     result = mbk.tf(data, 'input', 'torque', 'output', 'angle', 'poles', 4, 'zeros', 3);
%
%   Errors are mbk:usage, mbk:data and mbk:not_usable; warnings are mbk:CODE, with _ for -.
%   See also mbk.explore
  [result, info] = mbk.internal.run('tf', varargin);
end
